#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

/// What one frame's answer is worth. Only `ok` carries a measurement of this frame; every other
/// verdict but `first_frame` predicts, and its covariance grows.
enum class Verdict {
  ok,
  first_frame,         ///< nothing to compare with yet
  too_little_texture,  ///< black, white, blurred or bare: the windows know too little
  too_few_inliers,     ///< no one motion explains the windows (moving water, traffic)
  ill_conditioned,     ///< some direction of motion is not observable
  horizon,             ///< too little ground below the horizon
  frozen,              ///< the same image again
  lost,                ///< the alignment did not converge
  time_gap,            ///< stamps not ascending, or too far apart to predict across
  gated,               ///< the rotation from the reference changed faster than is believed
};

template <>
struct EnumNames<Verdict> {
  static constexpr auto value = std::to_array<std::pair<Verdict, std::string_view>>(
      {{Verdict::ok, "ok"},
       {Verdict::first_frame, "first_frame"},
       {Verdict::too_little_texture, "too_little_texture"},
       {Verdict::too_few_inliers, "too_few_inliers"},
       {Verdict::ill_conditioned, "ill_conditioned"},
       {Verdict::horizon, "horizon"},
       {Verdict::frozen, "frozen"},
       {Verdict::lost, "lost"},
       {Verdict::time_gap, "time_gap"},
       {Verdict::gated, "gated"}});
};

/// The pose of that frame is known, not predicted.
[[nodiscard]] constexpr bool is_measured(Verdict verdict) {
  return verdict == Verdict::ok || verdict == Verdict::first_frame;
}

/// Where the metres come from.
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
