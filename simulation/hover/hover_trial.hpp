#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "flow/frame.hpp"
#include "navigation/navigation_estimate.hpp"
#include "simulation/hover/hover_config.hpp"
#include "simulation/hover/hover_estimate_error.hpp"
#include "simulation/hover/hover_plant.hpp"
#include "simulation/hover/hover_world.hpp"
#include "stabilization/hold_decision.hpp"

namespace stillkite {

/// The truth of an instant of a trial, one a frame of the camera, and what was then in force.
struct TrialSample {
  double t_s = 0;
  Eigen::Vector3d displacement_in_world_m =
      Eigen::Vector3d::Zero();  ///< of the drone from its place at the start
  Eigen::Vector3d drone_in_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d station_in_world_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0;  ///< from that of the start, left is +
  HoldAction action = HoldAction::hold;
  HoldReason reason = HoldReason::no_estimate;
  Verdict verdict = Verdict::first_frame;  ///< of the estimate that is flown by
  TetherCommand command;
};

struct TrialRecord {
  Trial trial;
  std::vector<TrialSample> samples;
  std::vector<YawKick> kicks;                  ///< that turned the drone
  std::vector<EstimateError> estimate_errors;  ///< one an image that was looked at
};

/// The trials in the paper's order: axis x, y, z, each with stabilization first. Flights of one
/// number along different axes have different seeds.
[[nodiscard]] std::vector<Trial> make_trials(const HoverConfig& config);

/// Is told every image that was looked at, with its estimate and the decision that followed; may
/// throw to end the trial.
using TrialObserver =
    std::function<void(const Frame&, const NavigationEstimate&, const HoldDecision&)>;

/// Flies one trial in closed loop: plant, sensors, rendered images, estimator and controller. The
/// same record for the same configuration and trial, on one machine bit for bit.
[[nodiscard]] TrialRecord fly_trial(const HoverConfig& config, const HoverWorld& world,
                                    const Trial& trial, const TrialObserver& observer = {});

}  // namespace stillkite
