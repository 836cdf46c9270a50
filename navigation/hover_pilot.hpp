#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "navigation/navigator.hpp"
#include "navigation/station_attitude.hpp"
#include "stabilization/hold_controller.hpp"

namespace stillkite {

/// What a tethered drone's computer knows beside an image when its command goes out.
struct TetheredReadings {
  Timestamp now;                        ///< of the command, not before the exposure
  std::optional<TetherReading> tether;  ///< the latest
  /// At the exposure: IMU, heading zeroed at take-off. None: as StationAttitude has it.
  std::optional<Eigen::Quaterniond> station_from_body;
  SensorReadings others;  ///< what the navigator may use
};

struct PilotStep {
  NavigationEstimate estimate;
  HoldDecision decision;
};

/// One frame's journey on a tethered drone: how it has moved, and the command that takes it back.
class HoverPilot {
 public:
  /// Throws InputError as Navigator and HoldController do. `body_from_camera`: the gimbal's, which
  /// keeps tilt and roll.
  HoverPilot(const Camera& camera, const RigidTransform& body_from_camera,
             const NavigatorConfig& navigator, const EstimatorConfig& estimator,
             const HoldConfig& hold, const InitialState& initial);

  PilotStep step(const Frame& frame, const TetheredReadings& readings);

  [[nodiscard]] std::vector<WindowFlow> windows() const { return navigator_.windows(); }

 private:
  RigidTransform body_from_camera_;
  Navigator navigator_;
  StationAttitude attitude_;
  HoldController controller_;
  std::optional<Matrix6d> start_covariance_;  // of the first frame's pose
};

/// What an estimate says to the controller: of the reference estimator its own answer, from a later
/// reference with the attitude carried on from the first; of the flow navigator and of the fusion
/// the way from the first frame's camera, of whose pose `start_covariance` was told then, metric
/// where there is a scale; of a fusion that has none yet, the reference estimator's answer. Which
/// status follows from what is seen: docs/choice.md.
[[nodiscard]] MotionEstimate motion_estimate(const NavigationEstimate& estimate,
                                             const Matrix6d& start_covariance,
                                             const RigidTransform& body_from_camera);

}  // namespace stillkite
