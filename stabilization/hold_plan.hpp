#pragma once

#include <Eigen/Core>
#include <array>

#include "stabilization/hold_config.hpp"
#include "stabilization/hold_decision.hpp"
#include "stabilization/pid.hpp"
#include "stabilization/velocity_model.hpp"

namespace stillkite {

/// Of length, elevation, azimuth and yaw in the paper's mode; of x, y, z in the station's frame and
/// yaw in the recommended one.
using HoldAxes = std::array<PidState, 4>;

/// What the controllers carry from one decision to the next.
struct HoldMemory {
  HoldAxes axes;
  /// The rate at which the way home grows without commands, in the mean of the last seconds: the
  /// opposite of the station's motion, without gusts. Of the recommended mode.
  Eigen::Vector3d drift_in_station_m_s = Eigen::Vector3d::Zero();
};

/// What to command, and what to remember.
struct HoldPlan {
  TetherCommand command;                 ///< within the limits
  HoldReason reason = HoldReason::none;  ///< why the drone is not moved, if it is not
  Eigen::Vector3d way_home_in_station_m = Eigen::Vector3d::Zero();
  double turn_home_rad = 0;
  HoldMemory memory;
};

/// Hold paper, sections III (thresholds) and IV: angles first, then the mean shift, then the unit
/// translation as metres to a desired length, elevation and azimuth, each with its own PID.
/// For an input with `reason_to_hold` none.
[[nodiscard]] HoldPlan plan_as_in_paper(const HoldConfig& config, const HoldInput& input,
                                        const HoldMemory& before, double dt_s);

/// State feedback or PI on the predicted way home, docs/hold_controller.md. For an input with
/// `reason_to_hold` none.
[[nodiscard]] HoldPlan plan_recommended(const HoldConfig& config, const HoldInput& input,
                                        const HoldMemory& before, const VelocityModel& own,
                                        double dt_s);

/// At rest: the integral stays, what remembers the last error does not.
[[nodiscard]] PidState at_rest(const PidState& state);

}  // namespace stillkite
