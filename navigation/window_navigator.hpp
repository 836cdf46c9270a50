#pragma once

#include <vector>

#include "estimation/sliding_window/sliding_window.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/keyframe_features.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator_config.hpp"
#include "navigation/sensor_readings.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

/// Policy fused with `fusion.solver: window`: visual-inertial sliding window (docs/fusion.md).
/// Needs an IMU; scale, roll and pitch come from it, no height is used. Body and IMU coincide.
class WindowNavigator {
 public:
  WindowNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                  const NavigatorConfig& config, const InitialState& initial);

  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings);

  [[nodiscard]] std::vector<WeightedFlow> flow_vectors() const { return features_.flow_vectors(); }

 private:
  [[nodiscard]] NavigationEstimate initialize(const Frame& frame);
  [[nodiscard]] Verdict verdict(const FrameInterval& interval) const;
  [[nodiscard]] NavigationEstimate answer(const Frame& frame, Verdict verdict,
                                          const std::vector<ImuSample>& samples,
                                          bool new_keyframe) const;

  RigidTransform body_from_camera_;
  RigidTransform world_from_initial_;  // camera at the first frame
  double initial_tilt_sigma_rad_;
  KeyframeFeatures features_;
  SlidingWindow window_;
  Eigen::Quaterniond world_from_keyframe_;  // camera
  Timestamp first_;
  Timestamp last_;
};

}  // namespace stillkite
