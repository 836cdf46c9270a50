#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "navigation/navigator.hpp"
#include "navigation/station_attitude.hpp"
#include "stabilization/hold_controller.hpp"

namespace stillkite {

/// Sensor inputs of a tethered drone for one frame.
struct TetheredReadings {
  Timestamp now;                        ///< time of the command, not before the exposure
  std::optional<TetherReading> tether;  ///< latest reading
  /// Attitude at the exposure (IMU, yaw zeroed at take-off); empty: StationAttitude supplies it.
  std::optional<Eigen::Quaterniond> station_from_body;
  SensorReadings sensors;  ///< readings for the navigator
};

struct PilotStep {
  NavigationEstimate estimate;
  HoldDecision decision;
};

/// Position hold of a tethered drone: estimates the displacement from the reference pose and
/// computes the tether command that corrects it.
class HoverPilot {
 public:
  /// `body_from_camera`: mount of the gimbal, which keeps pitch and roll.
  /// Throws InputError as Navigator and HoldController do.
  HoverPilot(const Camera& camera, const RigidTransform& body_from_camera,
             const NavigatorConfig& navigator, const EstimatorConfig& estimator,
             const HoldConfig& hold, const InitialState& initial);

  PilotStep step(const Frame& frame, const TetheredReadings& readings);

  [[nodiscard]] std::vector<WeightedFlow> flow_vectors() const { return navigator_.flow_vectors(); }

 private:
  RigidTransform body_from_camera_;
  Navigator navigator_;
  StationAttitude attitude_;
  HoldController controller_;
  std::optional<Matrix6d> initial_covariance_;  // of the first frame's pose
};

/// Motion relative to the reference pose, for the controller; status per policy:
/// docs/hold_control.md.
/// - Reference, or fusion without a scale: motion since the reference frame. After a reference
///   change the attitude is chained to the first one.
/// - Flow, or fusion with a scale: motion since the first frame, metric if there is a scale.
/// `initial_covariance`: pose covariance of the first frame's estimate.
[[nodiscard]] MotionEstimate motion_estimate(const NavigationEstimate& estimate,
                                             const Matrix6d& initial_covariance,
                                             const RigidTransform& body_from_camera);

}  // namespace stillkite
