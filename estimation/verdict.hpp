#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

/// Status of one frame.
///
/// `ok`: the frame was measured. `first_frame`: initial pose. `still`: zero velocity was measured,
/// the pose is held. Every other verdict: the pose is predicted and its covariance grows.
enum class Verdict {
  ok,
  first_frame,         ///< no previous frame
  too_little_texture,  ///< too few textured tiles: dark, saturated, blurred or uniform image
  too_few_inliers,     ///< no single motion fits (moving water, traffic)
  not_flat,            ///< one plane does not explain the images
  ill_conditioned,     ///< a direction of motion is not observable
  horizon,             ///< too little ground below the horizon
  frozen,              ///< image repeated
  lost,                ///< the alignment did not converge
  time_gap,            ///< stamps not ascending, or gap too long to predict across
  gated,               ///< rotation to the reference rejected by the rate gate
  still,               ///< camera at rest: no image displacement for half a second
};

template <>
struct EnumNames<Verdict> {
  static constexpr auto value = std::to_array<std::pair<Verdict, std::string_view>>(
      {{Verdict::ok, "ok"},
       {Verdict::first_frame, "first_frame"},
       {Verdict::too_little_texture, "too_little_texture"},
       {Verdict::too_few_inliers, "too_few_inliers"},
       {Verdict::not_flat, "not_flat"},
       {Verdict::ill_conditioned, "ill_conditioned"},
       {Verdict::horizon, "horizon"},
       {Verdict::frozen, "frozen"},
       {Verdict::lost, "lost"},
       {Verdict::time_gap, "time_gap"},
       {Verdict::gated, "gated"},
       {Verdict::still, "still"}});
};

/// True if the frame's motion is measured or its pose given, not predicted.
[[nodiscard]] constexpr bool is_measured(Verdict verdict) {
  return verdict == Verdict::ok || verdict == Verdict::first_frame || verdict == Verdict::still;
}

/// Source of the metric scale.
enum class ScaleSource { none, initial_height, range, barometer, imu };

template <>
struct EnumNames<ScaleSource> {
  static constexpr auto value = std::to_array<std::pair<ScaleSource, std::string_view>>(
      {{ScaleSource::none, "none"},
       {ScaleSource::initial_height, "initial_height"},
       {ScaleSource::range, "range"},
       {ScaleSource::barometer, "barometer"},
       {ScaleSource::imu, "imu"}});
};

}  // namespace stillkite
