#include "simulation/render/render_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulation/render/render_kernel.cpp"
#include <hwy/foreach_target.h>
// must follow foreach_target.h
#include <hwy/highway.h>

#include "simulation/render/texture_sampling-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {

constexpr float kMinDown = 1e-3F;  // a smaller down . b is at or above the horizon

HWY_INLINE VF at_depth(const RayFunction& function, VF x, VF y, VF depth) {
  return hn::MulAdd(depth, along(function.per_bearing, x, y), hn::Set(F(), function.at_camera));
}

HWY_INLINE VU gather(const std::uint32_t* words, VI index) {
  return hn::GatherIndex(U(), words, index);
}

// Two adjacent pairs of a GroundTexture.
HWY_INLINE VU gather_quad(const std::uint8_t* pairs, VI index) {
  return hn::GatherOffset(U(), reinterpret_cast<const std::uint32_t*>(pairs),
                          hn::ShiftLeft<1>(index));
}

// Reduces an integer coordinate to [-(size - 1), size - 1], one period of the mirrored texture.
HWY_INLINE VF reduce(VF whole, float size) {
  const F f;
  const float period = 2 * (size - 1);
  const VF periods = hn::Round(hn::Mul(whole, hn::Set(f, 1 / period)));
  return hn::NegMulAdd(periods, hn::Set(f, period), whole);
}

// Reflection at zero: -(whole + fraction) = (-1 - whole) + (1 - fraction) for whole < 0.
HWY_INLINE VF fold_whole(VF whole) {
  const F f;
  const auto negative = hn::Lt(whole, hn::Zero(f));
  return hn::IfThenElse(negative, hn::Sub(hn::Set(f, -1.0F), whole), whole);
}
HWY_INLINE VF fold_fraction(VF whole, VF fraction) {
  const F f;
  const auto negative = hn::Lt(whole, hn::Zero(f));
  return hn::IfThenElse(negative, hn::Sub(hn::Set(f, 1.0F), fraction), fraction);
}

// Bilinear sample of a pyramid level at coordinates of the finest level.
HWY_INLINE VF sample_level(const RenderView& view, VI level, VF u, VF v) {
  const F f;
  const I i;
  const VF half = hn::Set(f, 0.5F);
  const VF scale = hn::GatherIndex(f, view.level_scale.data(), level);
  const VI width = hn::GatherIndex(i, view.level_width.data(), level);
  const VI height = hn::GatherIndex(i, view.level_height.data(), level);
  const VI pitch = hn::GatherIndex(i, view.level_pitch.data(), level);
  const VF last_u = hn::ConvertTo(f, hn::Sub(width, hn::Set(i, 1)));
  const VF last_v = hn::ConvertTo(f, hn::Sub(height, hn::Set(i, 1)));
  const VF at_u = hn::Min(hn::Max(hn::MulSub(hn::Add(u, half), scale, half), hn::Zero(f)), last_u);
  const VF at_v = hn::Min(hn::Max(hn::MulSub(hn::Add(v, half), scale, half), hn::Zero(f)), last_v);
  const VI column = hn::ConvertTo(i, at_u);
  const VI row = hn::ConvertTo(i, at_v);
  const VI index = hn::Add(hn::GatherIndex(i, view.level_offset.data(), level),
                           hn::Add(hn::Mul(row, pitch), column));
  return within_quad(gather_quad(view.pairs, index), hn::Sub(at_u, hn::ConvertTo(f, column)),
                     hn::Sub(at_v, hn::ConvertTo(f, row)));
}

// Trilinear interpolation: level = log2(footprint). Distant ground is averaged instead of aliased.
HWY_INLINE VF sample_pyramid(const RenderView& view, VF footprint, VF u, VF v) {
  const F f;
  const I i;
  const VF level = hn::Min(hn::Max(approximate_log2(footprint), hn::Zero(f)),
                           hn::Set(f, static_cast<float>(view.levels - 1)));
  const VI fine = hn::ConvertTo(i, level);
  const VI coarse = hn::Min(hn::Add(fine, hn::Set(i, 1)), hn::Set(i, view.levels - 1));
  return blend(sample_level(view, fine, u, v), sample_level(view, coarse, u, v),
               hn::Sub(level, hn::ConvertTo(f, fine)));
}

HWY_INLINE VF sample_ground(const RenderView& view, VF x, VF y, VF depth, Mask below) {
  const F f;
  const I i;
  const VF u = hn::IfThenElseZero(below, at_depth(view.u, x, y, depth));
  const VF v = hn::IfThenElseZero(below, at_depth(view.v, x, y, depth));
  const VF floor_u = hn::Floor(u);
  const VF floor_v = hn::Floor(v);
  const VF whole_u =
      reduce(hn::Add(floor_u, hn::Set(f, view.base_u)), static_cast<float>(view.level_width[0]));
  const VF whole_v =
      reduce(hn::Add(floor_v, hn::Set(f, view.base_v)), static_cast<float>(view.level_height[0]));
  const VF column = fold_whole(whole_u);
  const VF row = fold_whole(whole_v);
  const VF a = fold_fraction(whole_u, hn::Sub(u, floor_u));
  const VF b = fold_fraction(whole_v, hn::Sub(v, floor_v));

  const VF footprint = hn::Mul(hn::Mul(depth, depth), hn::Set(f, view.texels_per_square_depth));
  if (hn::AllTrue(f, hn::Le(footprint, hn::Set(f, 1.0F)))) {
    const VI index = hn::Add(hn::Mul(hn::ConvertTo(i, row), hn::Set(i, view.level_pitch[0])),
                             hn::ConvertTo(i, column));
    return within_quad(gather_quad(view.pairs, index), a, b);
  }
  return sample_pyramid(view, footprint, hn::Add(column, a), hn::Add(row, b));
}

// Relief height z at the horizontal position of the ray at `depth`.
HWY_INLINE VF relief_height(const RenderView& view, VF x, VF y, VF depth) {
  const F f;
  const I i;
  const VF at_x = at_depth(view.relief_x, x, y, depth);
  const VF at_y = at_depth(view.relief_y, x, y, depth);
  const VF floor_x = hn::Floor(at_x);
  const VF floor_y = hn::Floor(at_y);
  const VF a = hn::Sub(at_x, floor_x);
  const VF b = hn::Sub(at_y, floor_y);
  constexpr int kSide = 1024;
  const VI wrap = hn::Set(i, kSide - 1);
  const VI column = hn::And(hn::ConvertTo(i, floor_x), wrap);
  const VI row = hn::ConvertTo(i, floor_y);
  const VI here = hn::Add(hn::ShiftLeft<10>(hn::And(row, wrap)), column);
  const VI below = hn::Add(hn::ShiftLeft<10>(hn::And(hn::Add(row, hn::Set(i, 1)), wrap)), column);
  const VI upper = hn::BitCast(i, gather(view.relief_words, here));
  const VI lower = hn::BitCast(i, gather(view.relief_words, below));
  const auto left = [](VI pair) HWY_ATTR {
    return hn::ConvertTo(F(), hn::ShiftRight<16>(hn::ShiftLeft<16>(pair)));
  };
  const auto right = [](VI pair) HWY_ATTR { return hn::ConvertTo(F(), hn::ShiftRight<16>(pair)); };
  const VF counts =
      blend(blend(left(upper), right(upper), a), blend(left(lower), right(lower), a), b);
  return hn::Mul(counts, hn::Set(f, view.relief_metres_per_count));
}

HWY_INLINE VF paint_vehicle(const RenderView& view, VF x, VF y, VF depth, VF grey) {
  const F f;
  const I i;
  const VF one = hn::Set(f, 1.0F);
  const VF along = at_depth(view.vehicle_along, x, y, depth);
  const VF across = at_depth(view.vehicle_across, x, y, depth);
  const auto inside = hn::And(hn::Lt(hn::Abs(along), one), hn::Lt(hn::Abs(across), one));
  if (hn::AllFalse(f, inside)) return grey;
  const VF half_u = hn::Set(f, 0.5F * static_cast<float>(view.vehicle_width - 1));
  const VF half_v = hn::Set(f, 0.5F * static_cast<float>(view.vehicle_height - 1));
  const VF u = hn::IfThenElseZero(inside, hn::MulAdd(along, half_u, half_u));
  const VF v = hn::IfThenElseZero(inside, hn::MulAdd(across, half_v, half_v));
  const VI column = hn::ConvertTo(i, u);
  const VI row = hn::ConvertTo(i, v);
  const VI index = hn::Add(hn::Mul(row, hn::Set(i, view.vehicle_pitch)), column);
  const VF paint =
      within_quad(gather_quad(view.vehicle_pairs, index), hn::Sub(u, hn::ConvertTo(f, column)),
                  hn::Sub(v, hn::ConvertTo(f, row)));
  return hn::IfThenElse(inside, paint, grey);
}

// `z`: height of the ground.
HWY_INLINE VF cast_shadow(const RenderView& view, VF x, VF y, VF depth, VF z, VF grey) {
  const F f;
  const VF along = hn::NegMulAdd(z, hn::Set(f, view.shadow_along_per_height),
                                 at_depth(view.shadow_along, x, y, depth));
  const VF across = at_depth(view.shadow_across, x, y, depth);
  const VF radius = hn::Sqrt(hn::MulAdd(along, along, hn::Mul(across, across)));
  const VF one = hn::Set(f, 1.0F);
  const VF ramp = hn::Mul(hn::Sub(one, radius), hn::Set(f, view.shadow_ramp));
  const VF share = hn::Min(hn::Max(ramp, hn::Zero(f)), one);
  return hn::NegMulAdd(hn::Mul(share, hn::Set(f, view.shadow_darkening_ratio)), grey, grey);
}

template <bool kRelief, bool kVehicle, bool kShadow>
void render(const RenderView& view, const RenderRow& row) {
  const F f;
  const VF weight = hn::Set(f, 1.0F / static_cast<float>(row.samples));
  const VF height = hn::Set(f, view.height_m);
  for (int column = 0; column < row.count; column += static_cast<int>(hn::Lanes(f))) {
    VF sum = hn::Zero(f);
    for (int sample = 0; sample < row.samples; ++sample) {
      const VF x = hn::LoadU(f, row.bearing_x[sample] + column);
      const VF y = row.uniform_y ? hn::Set(f, *row.bearing_y[sample])
                                 : hn::LoadU(f, row.bearing_y[sample] + column);
      const VF down = along(view.down_per_bearing, x, y);
      const auto below = hn::Gt(down, hn::Set(f, kMinDown));
      const VF per_metre = hn::IfThenElseZero(below, hn::Div(hn::Set(f, 1.0F), down));
      VF depth = hn::Mul(height, per_metre);
      VF z = hn::Zero(f);
      if constexpr (kRelief) {
        z = hn::LoadU(f, row.ground_height_m[sample] + column);
        for (int step = 0; step < view.relief_steps; ++step) {
          z = relief_height(view, x, y, hn::Mul(hn::Sub(height, z), per_metre));
        }
        z = hn::IfThenElseZero(below, z);  // undefined, possibly NaN, above the horizon
        hn::StoreU(z, f, row.ground_height_m[sample] + column);
        depth = hn::Mul(hn::Sub(height, z), per_metre);
      }
      VF grey = sample_ground(view, x, y, depth, below);
      if constexpr (kVehicle) grey = paint_vehicle(view, x, y, depth, grey);
      if constexpr (kShadow) grey = cast_shadow(view, x, y, depth, z, grey);
      sum = hn::Add(sum, hn::IfThenElse(below, grey, hn::Set(f, view.sky_grey)));
    }
    hn::StoreU(hn::Mul(sum, weight), f, row.grey + column);
  }
}

template <bool kShadow>
void render_with(const RenderView& view, const RenderRow& row) {
  const bool relief = view.relief_words != nullptr;
  const bool vehicle = view.vehicle_pairs != nullptr;
  if (relief && vehicle) return render<true, true, kShadow>(view, row);
  if (relief) return render<true, false, kShadow>(view, row);
  if (vehicle) return render<false, true, kShadow>(view, row);
  render<false, false, kShadow>(view, row);
}

void render_dispatched(const RenderView& view, const RenderRow& row) {
  if (view.shadow_darkening_ratio > 0) return render_with<true>(view, row);
  render_with<false>(view, row);
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(render_dispatched);

void render_row(const RenderView& view, const RenderRow& row) {
  HWY_DYNAMIC_DISPATCH(render_dispatched)(view, row);
}

}  // namespace stillkite
#endif
