#include <algorithm>

#include "flow/dense_lucas_kanade_rows.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flow/flow_upsampling.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stillkite::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void upsample_flow_simd(Rows<const float> coarse, int coarse_width, int coarse_height,
                        Rows<float> fine, int width, int height, float* line) {
  const hn::ScalableTag<float> d;
  using Floats = hn::Vec<decltype(d)>;
  const int lanes = static_cast<int>(hn::Lanes(d));
  float* const line_x = line;
  float* const line_y = line + coarse_width + kRowMargin;
  for (int y = 0; y < height; ++y) {
    const float* const upper = coarse.row(y / 2);
    const float* const lower = coarse.row(std::min((y + 1) / 2, coarse_height - 1));
    for (int x = 0; x < coarse_width; x += lanes) {
      Floats upper_x, upper_y, lower_x, lower_y;
      hn::LoadInterleaved2(d, upper + 2 * x, upper_x, upper_y);
      hn::LoadInterleaved2(d, lower + 2 * x, lower_x, lower_y);
      hn::StoreU(hn::Add(upper_x, lower_x), d, line_x + x);
      hn::StoreU(hn::Add(upper_y, lower_y), d, line_y + x);
    }
    line_x[coarse_width] = line_x[coarse_width - 1];
    line_y[coarse_width] = line_y[coarse_width - 1];
    const Floats half = hn::Set(d, 0.5F);
    for (int x = 0; 2 * x < width; x += lanes) {
      const Floats even_x = hn::LoadU(d, line_x + x), even_y = hn::LoadU(d, line_y + x);
      const Floats odd_x = hn::Mul(half, hn::Add(even_x, hn::LoadU(d, line_x + x + 1)));
      const Floats odd_y = hn::Mul(half, hn::Add(even_y, hn::LoadU(d, line_y + x + 1)));
      hn::StoreInterleaved4(even_x, even_y, odd_x, odd_y, d, fine.row(y) + 4 * x);
    }
  }
}

}  // namespace stillkite::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(upsample_flow_simd);

void upsample_flow(Rows<const float> coarse, int coarse_width, int coarse_height, Rows<float> fine,
                   int width, int height, float* line) {
  HWY_DYNAMIC_DISPATCH(upsample_flow_simd)
  (coarse, coarse_width, coarse_height, fine, width, height, line);
}

}  // namespace stillkite
#endif
