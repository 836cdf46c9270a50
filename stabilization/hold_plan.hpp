#pragma once

#include <Eigen/Core>
#include <array>

#include "stabilization/hold_config.hpp"
#include "stabilization/hold_decision.hpp"
#include "stabilization/pid.hpp"
#include "stabilization/velocity_model.hpp"

namespace stillkite {

/// Controllers of length, elevation, azimuth and yaw in mode paper; of x, y, z in the station's
/// frame and yaw in mode recommended.
using HoldAxes = std::array<PidState, 4>;

/// State of the controllers between two decisions.
struct HoldState {
  HoldAxes axes;
  /// Low-passed growth rate of the position error without commands: minus the station's velocity,
  /// without gusts. Mode recommended only.
  Eigen::Vector3d drift_in_station_m_s = Eigen::Vector3d::Zero();
};

/// Command and next state.
struct HoldPlan {
  TetherCommand command;                 ///< within the limits
  HoldReason reason = HoldReason::none;  ///< reason for no translation command
  Eigen::Vector3d position_error_in_station_m = Eigen::Vector3d::Zero();
  double yaw_error_rad = 0;
  HoldState state;
};

/// Hold paper, sections III (thresholds) and IV: angles, then the mean shift, then the unit
/// translation in metres to a desired length, elevation and azimuth, one PID each.
/// Precondition: `reason_to_hold` is none.
[[nodiscard]] HoldPlan plan_paper(const HoldConfig& config, const HoldInput& input,
                                  const HoldState& before, double dt_s);

/// State feedback or PI on the predicted position error, docs/hold_control.md.
/// Precondition: `reason_to_hold` is none.
[[nodiscard]] HoldPlan plan_recommended(const HoldConfig& config, const HoldInput& input,
                                        const HoldState& before,
                                        const VelocityModel& velocity_model, double dt_s);

/// The state's integral alone, without the last error and output.
[[nodiscard]] PidState integral_of(const PidState& state);

}  // namespace stillkite
