#include "flow/dense_lucas_kanade_rows.hpp"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flow/dense_lucas_kanade_rows.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#ifndef STILLKITE_FLOW_DENSE_LUCAS_KANADE_ROWS_ONCE
#define STILLKITE_FLOW_DENSE_LUCAS_KANADE_ROWS_ONCE
namespace stillkite {
namespace {

// Limit of the linearization.
constexpr float kMaxStepPx = 2.0F;

// Sums over a column of the window: g g' (xx, xy, yy), g e (x, y), g (x, y), e, 1.
enum Sum { kXx, kXy, kYy, kXe, kYe, kX, kY, kE, kCount, kSums };

// Gradient, residual and validity of a row, stored while the row is in the window.
enum Term { kGradientX, kGradientY, kResidual, kInside, kTerms };

// Rows of floats with kRowMargin zeros on both sides.
std::ptrdiff_t scratch_stride(int width) {
  return (width + kRowMargin - 1) / kRowMargin * kRowMargin + 2 * kRowMargin;
}

}  // namespace
}  // namespace stillkite
#endif

HWY_BEFORE_NAMESPACE();
namespace stillkite::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::ScalableTag<std::int32_t>;
using Floats = hn::Vec<FloatTag>;
using Ints = hn::Vec<IntTag>;

constexpr FloatTag kF;
constexpr IntTag kI;

HWY_INLINE Floats load_bytes(const std::uint8_t* at) {
  const hn::Rebind<std::uint8_t, FloatTag> bytes;
  return hn::ConvertTo(kF, hn::PromoteTo(kI, hn::LoadU(bytes, at)));
}

// Four adjacent bytes per lane: one gather loads both pixels of a row for bilinear interpolation.
HWY_INLINE Ints gather_four_bytes(const std::uint8_t* base, Ints offset) {
#if HWY_TARGET == HWY_SCALAR
  std::int32_t four = 0;
  std::memcpy(&four, base + hn::GetLane(offset), sizeof(four));
  return hn::Set(kI, four);
#else
  return hn::GatherOffset(kI, reinterpret_cast<const std::int32_t*>(base), offset);
#endif
}

template <int kByte>
HWY_INLINE Floats byte_of(Ints four) {
  return hn::ConvertTo(kF, hn::And(hn::ShiftRight<8 * kByte>(four), hn::Set(kI, 255)));
}

struct Terms {
  Floats gradient_x, gradient_y, residual, inside;
};

// Central-difference gradient of the previous image at (x, y) and residual (bilinearly warped
// current minus previous image); zero outside the image.
HWY_INLINE Terms terms_at(const DenseStep& step, int x, int y) {
  const Floats zero = hn::Zero(kF);
  const Floats last_x = hn::Set(kF, static_cast<float>(step.width - 1));
  const Floats last_y = hn::Set(kF, static_cast<float>(step.height - 1));
  const Floats column = hn::Iota(kF, static_cast<float>(x));
  Floats warp_x, warp_y;
  hn::LoadInterleaved2(kF, step.warp.row(y) + 2 * x, warp_x, warp_y);
  const Floats to_x = hn::Add(column, warp_x);
  const Floats to_y = hn::Add(hn::Set(kF, static_cast<float>(y)), warp_y);
  const Floats in_x = hn::Min(hn::Max(to_x, zero), last_x);
  const Floats in_y = hn::Min(hn::Max(to_y, zero), last_y);
  const auto inside = hn::And(hn::And(hn::Eq(to_x, in_x), hn::Eq(to_y, in_y)),
                              hn::And(hn::Gt(column, zero), hn::Lt(column, last_x)));

  const Ints corner_x = hn::ConvertTo(kI, in_x);
  const Ints corner_y = hn::ConvertTo(kI, in_y);
  const Floats ax = hn::Sub(in_x, hn::ConvertTo(kF, corner_x));
  const Floats ay = hn::Sub(in_y, hn::ConvertTo(kF, corner_y));
  const Ints stride = hn::Set(kI, static_cast<std::int32_t>(step.current.stride));
  const Ints offset = hn::Add(hn::Mul(corner_y, stride), corner_x);
  const Ints upper = gather_four_bytes(step.current.data, offset);
  const Ints lower = gather_four_bytes(step.current.data, hn::Add(offset, stride));
  const Floats a = byte_of<0>(upper), b = byte_of<1>(upper);
  const Floats c = byte_of<0>(lower), d = byte_of<1>(lower);
  const Floats top = hn::MulAdd(ax, hn::Sub(b, a), a);
  const Floats bottom = hn::MulAdd(ax, hn::Sub(d, c), c);
  const Floats warped = hn::MulAdd(ay, hn::Sub(bottom, top), top);

  const std::uint8_t* at = step.previous.row(y) + x;
  const std::ptrdiff_t down = step.previous.stride;
  const Floats half = hn::Set(kF, 0.5F);
  const Floats gx = hn::Mul(half, hn::Sub(load_bytes(at + 1), load_bytes(at - 1)));
  const Floats gy = hn::Mul(half, hn::Sub(load_bytes(at + down), load_bytes(at - down)));
  return {hn::IfThenElseZero(inside, gx), hn::IfThenElseZero(inside, gy),
          hn::IfThenElseZero(inside, hn::Sub(warped, load_bytes(at))),
          hn::IfThenElseZero(inside, hn::Set(kF, 1.0F))};
}

// Adds row y to the column sums and subtracts the oldest row, held in `terms`.
void advance_columns(const DenseStep& step, int y, float* sums, float* terms) {
  const std::ptrdiff_t stride = scratch_stride(step.width);
  const bool inside = y > 0 && y < step.height - 1;
  for (int x = 0; x < step.width; x += static_cast<int>(hn::Lanes(kF))) {
    const Floats zero = hn::Zero(kF);
    const Terms in = inside ? terms_at(step, x, y) : Terms{zero, zero, zero, zero};
    float* const gx = terms + kGradientX * stride + x;
    float* const gy = terms + kGradientY * stride + x;
    float* const e = terms + kResidual * stride + x;
    float* const one = terms + kInside * stride + x;
    const Terms out{hn::Load(kF, gx), hn::Load(kF, gy), hn::Load(kF, e), hn::Load(kF, one)};
    const auto exchange = [&](Sum which, Floats in1, Floats in2, Floats out1, Floats out2) {
      float* const sum = sums + which * stride + x;
      const Floats with_new = hn::MulAdd(in1, in2, hn::Load(kF, sum));
      hn::Store(hn::NegMulAdd(out1, out2, with_new), kF, sum);
    };
    const auto exchange_one = [&](Sum which, Floats in1, Floats out1) {
      float* const sum = sums + which * stride + x;
      hn::Store(hn::Add(hn::Load(kF, sum), hn::Sub(in1, out1)), kF, sum);
    };
    exchange(kXx, in.gradient_x, in.gradient_x, out.gradient_x, out.gradient_x);
    exchange(kXy, in.gradient_x, in.gradient_y, out.gradient_x, out.gradient_y);
    exchange(kYy, in.gradient_y, in.gradient_y, out.gradient_y, out.gradient_y);
    exchange(kXe, in.gradient_x, in.residual, out.gradient_x, out.residual);
    exchange(kYe, in.gradient_y, in.residual, out.gradient_y, out.residual);
    exchange_one(kX, in.gradient_x, out.gradient_x);
    exchange_one(kY, in.gradient_y, out.gradient_y);
    exchange_one(kE, in.residual, out.residual);
    exchange_one(kCount, in.inside, out.inside);
    hn::Store(in.gradient_x, kF, gx);
    hn::Store(in.gradient_y, kF, gy);
    hn::Store(in.residual, kF, e);
    hn::Store(in.inside, kF, one);
  }
}

// Sums of four adjacent columns: a window of 15 then needs 3 + 3 additions instead of 15.
void sum_fours(const DenseStep& step, const float* sums, float* fours) {
  const std::ptrdiff_t stride = scratch_stride(step.width);
  const int lanes = static_cast<int>(hn::Lanes(kF));
  const int first = -(step.radius + lanes - 1) / lanes * lanes;
  for (int which = 0; which < kSums; ++which) {
    for (int x = first; x < step.width + step.radius; x += lanes) {
      const float* const at = sums + which * stride + x;
      const Floats left = hn::Add(hn::Load(kF, at), hn::LoadU(kF, at + 1));
      const Floats right = hn::Add(hn::LoadU(kF, at + 2), hn::LoadU(kF, at + 3));
      hn::Store(hn::Add(left, right), kF, fours + which * stride + x);
    }
  }
}

HWY_INLINE Floats clamp(Floats value, float limit) {
  return hn::Min(hn::Max(value, hn::Set(kF, -limit)), hn::Set(kF, limit));
}

// Solves row y of the flow from the column sums.
void solve_row(const DenseStep& step, int y, const float* sums, const float* fours) {
  const std::ptrdiff_t stride = scratch_stride(step.width);
  const int window = 2 * step.radius + 1;
  const auto window_area = static_cast<float>(window * window);
  const Floats lambda = hn::Set(kF, window_area * step.regularisation);
  for (int x = 0; x < step.width; x += static_cast<int>(hn::Lanes(kF))) {
    const auto over_window = [&](Sum which) {
      const float* const ones = sums + which * stride + x - step.radius;
      const float* const four = fours + which * stride + x - step.radius;
      Floats sum = hn::Zero(kF);
      int i = 0;
      for (; i + 4 <= window; i += 4) sum = hn::Add(sum, hn::LoadU(kF, four + i));
      for (; i < window; ++i) sum = hn::Add(sum, hn::LoadU(kF, ones + i));
      return sum;
    };
    const Floats sum_x = over_window(kX), sum_y = over_window(kY);
    const Floats one = hn::Set(kF, 1.0F);
    const Floats per_pixel = hn::Div(one, hn::Max(over_window(kCount), one));
    const Floats mean_x = hn::Mul(sum_x, per_pixel), mean_y = hn::Mul(sum_y, per_pixel);
    const Floats sum_e = over_window(kE);
    const Floats xx = hn::NegMulAdd(mean_x, sum_x, over_window(kXx));
    const Floats xy = hn::NegMulAdd(mean_x, sum_y, over_window(kXy));
    const Floats yy = hn::NegMulAdd(mean_y, sum_y, over_window(kYy));
    const Floats xe = hn::NegMulAdd(mean_x, sum_e, over_window(kXe));
    const Floats ye = hn::NegMulAdd(mean_y, sum_e, over_window(kYe));

    const Floats a = hn::Add(xx, lambda), c = hn::Add(yy, lambda);
    // lower bound lambda^2: rounding must not change the sign of the determinant
    const Floats determinant = hn::Max(hn::MulSub(a, c, hn::Mul(xy, xy)), hn::Mul(lambda, lambda));
    const Floats inverse = hn::Div(one, determinant);
    const Floats step_x = hn::Mul(inverse, hn::MulSub(xy, ye, hn::Mul(c, xe)));
    const Floats step_y = hn::Mul(inverse, hn::MulSub(xy, xe, hn::Mul(a, ye)));
    Floats warp_x, warp_y;
    hn::LoadInterleaved2(kF, step.warp.row(y) + 2 * x, warp_x, warp_y);
    hn::StoreInterleaved2(hn::Add(warp_x, clamp(step_x, kMaxStepPx)),
                          hn::Add(warp_y, clamp(step_y, kMaxStepPx)), kF, step.flow.row(y) + 2 * x);

    if (step.information.data != nullptr) {
      const Floats half = hn::Set(kF, 0.5F);
      const Floats mean = hn::Mul(half, hn::Add(xx, yy));
      const Floats difference = hn::Mul(half, hn::Sub(xx, yy));
      const Floats root = hn::Sqrt(hn::MulAdd(difference, difference, hn::Mul(xy, xy)));
      const Floats smaller = hn::Max(hn::Zero(kF), hn::Sub(mean, root));
      hn::StoreU(hn::Mul(hn::Set(kF, 1.0F / window_area), smaller), kF,
                 step.information.row(y) + x);
    }
  }
}

}  // namespace

void step_rows_simd(const DenseStep& step, int first, int end, float* scratch) {
  const std::ptrdiff_t stride = scratch_stride(step.width);
  const int window = 2 * step.radius + 1;
  float* const sums = scratch + kRowMargin;
  float* const fours = sums + kSums * stride;
  float* const rows = fours + kSums * stride;
  std::fill(scratch, scratch + scratch_size(step.width, step.radius), 0.0F);
  for (int y = first - step.radius; y < end + step.radius; ++y) {
    const int slot = (y + window) % window;
    advance_columns(step, y, sums, rows + slot * kTerms * stride);
    const int centre = y - step.radius;
    if (centre < first) continue;
    sum_fours(step, sums, fours);
    solve_row(step, centre, sums, fours);
  }
}

}  // namespace stillkite::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(step_rows_simd);

std::size_t scratch_size(int width, int radius) {
  return static_cast<std::size_t>(scratch_stride(width)) *
         static_cast<std::size_t>(2 * kSums + kTerms * (2 * radius + 1));
}

void step_rows(const DenseStep& step, int first, int end, float* scratch) {
  HWY_DYNAMIC_DISPATCH(step_rows_simd)(step, first, end, scratch);
}

}  // namespace stillkite
#endif
