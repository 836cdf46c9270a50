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

/// Measurement of the tether's sensors, in the station's frame.
struct TetherReading {
  Timestamp stamp;
  TetherState tether;
  bool taut = true;  ///< if false, the length is not the distance of the drone
};

enum class HoldAction {
  hold,     ///< all rates are 0
  command,  ///< at least one rate is not 0
};
template <>
struct EnumNames<HoldAction> {
  static constexpr auto value = std::to_array<std::pair<HoldAction, std::string_view>>(
      {{HoldAction::hold, "hold"}, {HoldAction::command, "command"}});
};

/// Reason for no command, or for one that does not control both position and yaw.
enum class HoldReason {
  none,                  ///< position and yaw are both controlled
  not_engaged,           ///< live: no operator has engaged the controller
  stopped,               ///< live: an operator has stopped the commands of this flight
  station_mode,          ///< live: mode of the ground station, such as stick, landing or return
  station_fault,         ///< live: the ground station reports a fault
  station_silent,        ///< live: telemetry of the ground station is missing or too old
  not_measured,          ///< live: no image has been measured for longer than configured
  estimator_silent,      ///< live: no decision has reached the supervising process in time
  estimator_ended,       ///< live: the estimator's process has ended
  no_estimate,           ///< no estimate received yet
  estimate_lost,         ///< the estimator measured nothing
  estimate_gated,        ///< the estimator's gate rejected the measurement
  estimate_stale,        ///< too old, or stamped in the future
  not_finite,            ///< an input is not finite, or a quaternion has no unit norm
  no_tether_reading,     ///< no tether reading received yet
  tether_stale,          ///< too old, or stamped in the future
  tether_slack,          ///< `max_slack_m` limits the length
  tether_out_of_range,   ///< impossible length, elevation or azimuth
  at_limit,              ///< length or elevation is beyond its limit: only rates back to it
  angle_first,           ///< rotation is corrected, or awaited, before translation
  displacement_unknown,  ///< rotation is measured, translation is not
  within_dead_band,      ///< errors are within the dead bands
};
template <>
struct EnumNames<HoldReason> {
  static constexpr auto value = std::to_array<std::pair<HoldReason, std::string_view>>(
      {{HoldReason::none, "none"},
       {HoldReason::not_engaged, "not_engaged"},
       {HoldReason::stopped, "stopped"},
       {HoldReason::station_mode, "station_mode"},
       {HoldReason::station_fault, "station_fault"},
       {HoldReason::station_silent, "station_silent"},
       {HoldReason::not_measured, "not_measured"},
       {HoldReason::estimator_silent, "estimator_silent"},
       {HoldReason::estimator_ended, "estimator_ended"},
       {HoldReason::no_estimate, "no_estimate"},
       {HoldReason::estimate_lost, "estimate_lost"},
       {HoldReason::estimate_gated, "estimate_gated"},
       {HoldReason::estimate_stale, "estimate_stale"},
       {HoldReason::not_finite, "not_finite"},
       {HoldReason::no_tether_reading, "no_tether_reading"},
       {HoldReason::tether_stale, "tether_stale"},
       {HoldReason::tether_slack, "tether_slack"},
       {HoldReason::tether_out_of_range, "tether_out_of_range"},
       {HoldReason::at_limit, "at_limit"},
       {HoldReason::angle_first, "angle_first"},
       {HoldReason::displacement_unknown, "displacement_unknown"},
       {HoldReason::within_dead_band, "within_dead_band"}});
};

/// Inputs of the controller at a control instant.
struct HoldInput {
  Timestamp now;
  std::optional<MotionEstimate> estimate;  ///< latest
  std::optional<TetherReading> tether;     ///< latest
  /// Attitude of the camera at the estimate's exposure, from the IMU and the gimbal.
  Eigen::Quaterniond station_from_camera = Eigen::Quaterniond::Identity();
  /// Reason of operator or ground station to withhold the command; precedes all others.
  HoldReason withheld = HoldReason::none;
};

/// Command within the vehicle's limits for any input. Action `hold` always has a reason; `command`
/// with a reason controls yaw only, except on a slack tether.
struct HoldDecision {
  TetherCommand command;
  HoldAction action = HoldAction::hold;
  HoldReason reason = HoldReason::no_estimate;
  /// Errors to the reference pose at the exposure, reference minus camera, as the controller used
  /// them; in mode paper the position error is the unit translation. Yaw to the left is +.
  Eigen::Vector3d position_error_in_station_m = Eigen::Vector3d::Zero();
  double yaw_error_rad = 0;
};

}  // namespace stillkite
