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

/// Ground truth at a camera frame, with the command and estimate in use.
struct TrialSample {
  double t_s = 0;
  Eigen::Vector3d displacement_in_world_m =
      Eigen::Vector3d::Zero();  ///< of the drone from its initial position
  Eigen::Vector3d drone_in_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d station_in_world_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0;  ///< relative to the initial yaw, left is +
  HoldAction action = HoldAction::hold;
  HoldReason reason = HoldReason::no_estimate;
  Verdict verdict = Verdict::first_frame;  ///< of the latest estimate
  TetherCommand command;
};

struct TrialRecord {
  Trial trial;
  std::vector<TrialSample> samples;
  std::vector<YawKick> kicks;                  ///< yaw disturbances
  std::vector<EstimateError> estimate_errors;  ///< one per processed image
};

/// Trials in the paper's order: axis x, y, z; with stabilization first. Every trial has a different
/// seed.
[[nodiscard]] std::vector<Trial> make_trials(const HoverConfig& config);

/// Receives every processed image with its estimate and decision; an exception ends the trial.
using TrialObserver =
    std::function<void(const Frame&, const NavigationEstimate&, const HoldDecision&)>;

/// Simulates one trial in closed loop: plant, sensors, rendered images, estimator and controller.
/// Deterministic in configuration and trial; bit-identical on one machine.
[[nodiscard]] TrialRecord fly_trial(const HoverConfig& config, const HoverWorld& world,
                                    const Trial& trial, const TrialObserver& observer = {});

}  // namespace stillkite
