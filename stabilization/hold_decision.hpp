#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "estimation/motion_estimate.hpp"
#include "geometry/fields.hpp"
#include "geometry/time.hpp"
#include "stabilization/tether.hpp"

namespace stillkite {

/// What the tether's sensors said, in the station's frame.
struct TetherReading {
  Timestamp stamp;
  TetherState tether;
  bool taut = true;  ///< of a slack tether the length is no distance
};

/// All that the controller may know at a control instant.
struct HoldInput {
  Timestamp now;
  std::optional<MotionEstimate> estimate;  ///< the latest
  std::optional<TetherReading> tether;     ///< the latest
  /// Attitude of the camera at the estimate's exposure, from the IMU and the gimbal.
  Eigen::Quaterniond station_from_camera = Eigen::Quaterniond::Identity();
};

enum class HoldAction {
  hold,     ///< all rates are 0
  command,  ///< some rate is not 0
};
template <>
struct EnumNames<HoldAction> {
  static constexpr auto value = std::to_array<std::pair<HoldAction, std::string_view>>(
      {{HoldAction::hold, "hold"}, {HoldAction::command, "command"}});
};

/// Why nothing is commanded, or less than would bring the drone home.
enum class HoldReason {
  none,                  ///< position and yaw are both controlled
  no_estimate,           ///< none has arrived yet
  estimate_lost,         ///< the estimator measured nothing
  estimate_gated,        ///< the estimator does not yet believe what it measured
  estimate_stale,        ///< too old, or of the future
  not_finite,            ///< a number of the input is none, or a quaternion has no direction
  no_tether_reading,     ///< none has arrived yet
  tether_stale,          ///< too old, or of the future
  tether_slack,          ///< the reel pays out little more
  tether_out_of_range,   ///< a length or elevation that cannot be
  angle_first,           ///< rotation is corrected before translation, or awaited
  displacement_unknown,  ///< rotation is known, where home lies is not
  within_dead_band,      ///< nothing to correct
};
template <>
struct EnumNames<HoldReason> {
  static constexpr auto value = std::to_array<std::pair<HoldReason, std::string_view>>(
      {{HoldReason::none, "none"},
       {HoldReason::no_estimate, "no_estimate"},
       {HoldReason::estimate_lost, "estimate_lost"},
       {HoldReason::estimate_gated, "estimate_gated"},
       {HoldReason::estimate_stale, "estimate_stale"},
       {HoldReason::not_finite, "not_finite"},
       {HoldReason::no_tether_reading, "no_tether_reading"},
       {HoldReason::tether_stale, "tether_stale"},
       {HoldReason::tether_slack, "tether_slack"},
       {HoldReason::tether_out_of_range, "tether_out_of_range"},
       {HoldReason::angle_first, "angle_first"},
       {HoldReason::displacement_unknown, "displacement_unknown"},
       {HoldReason::within_dead_band, "within_dead_band"}});
};

/// A command that is within the vehicle's limits, whatever came in. `hold` always has a reason;
/// `command` with a reason turns the drone but does not move it, except on a slack tether.
struct HoldDecision {
  TetherCommand command;
  HoldAction action = HoldAction::hold;
  HoldReason reason = HoldReason::no_estimate;
  /// The way home and the turn home (left is +) at the exposure, as the command took them; in the
  /// paper's mode the way is its unit translation.
  Eigen::Vector3d way_home_in_station_m = Eigen::Vector3d::Zero();
  double turn_home_rad = 0;
};

}  // namespace stillkite
