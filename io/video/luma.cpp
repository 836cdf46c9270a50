#include "io/video/luma.hpp"

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/imgutils.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <array>
#include <utility>

namespace stillkite {
namespace {

bool has_luma_plane_of_8_bits(AVPixelFormat format) {
  const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(format);
  if (description == nullptr) return false;
  constexpr std::uint64_t kOther = AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL |
                                   AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_HWACCEL;
  const AVComponentDescriptor& luma = description->comp[0];
  return (description->flags & kOther) == 0 && luma.plane == 0 && luma.step == 1 &&
         luma.offset == 0 && luma.shift == 0 && luma.depth == 8;
}

}  // namespace

LumaExtractor::LumaExtractor() = default;
LumaExtractor::~LumaExtractor() = default;
LumaExtractor::LumaExtractor(LumaExtractor&&) noexcept = default;
LumaExtractor& LumaExtractor::operator=(LumaExtractor&&) noexcept = default;

void LumaExtractor::Free::operator()(SwsContext* context) const {
  sws_freeContext(context);
}

cv::Mat LumaExtractor::extract(const AVFrame& frame, cv::Mat recycled) {
  const auto format = static_cast<AVPixelFormat>(frame.format);
  recycled.create(frame.height, frame.width, CV_8UC1);
  const int step = static_cast<int>(recycled.step[0]);
  if (has_luma_plane_of_8_bits(format)) {
    av_image_copy_plane(recycled.data, step, frame.data[0], frame.linesize[0], frame.width,
                        frame.height);
    return recycled;
  }
  converter_.reset(sws_getCachedContext(converter_.release(), frame.width, frame.height, format,
                                        frame.width, frame.height, AV_PIX_FMT_GRAY8, SWS_POINT,
                                        nullptr, nullptr, nullptr));
  if (!converter_) return {};
  const std::array<std::uint8_t*, 4> planes{recycled.data};
  const std::array<int, 4> steps{step};
  sws_scale(converter_.get(), frame.data, frame.linesize, 0, frame.height, planes.data(),
            steps.data());
  return recycled;
}

}  // namespace stillkite
