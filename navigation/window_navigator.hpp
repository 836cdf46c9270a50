#pragma once

#include <optional>
#include <vector>

#include "estimation/sliding_window/keyframe_map.hpp"
#include "estimation/sliding_window/sliding_window.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/inertial_findings.hpp"
#include "navigation/keyframe_features.hpp"
#include "navigation/keyframe_navigator.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator_config.hpp"
#include "navigation/sensor_readings.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

/// Policy fused with `fusion.solver: window`: visual-inertial sliding window (docs/fusion.md).
/// Needs an IMU, which gives scale, roll and pitch; an initial height gives the scale before. Body
/// and IMU coincide.
class WindowNavigator {
 public:
  WindowNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                  const NavigatorConfig& config, const InitialState& initial);

  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings);

  [[nodiscard]] std::vector<WeightedFlow> flow_vectors() const { return features_.flow_vectors(); }
  /// Differences of IMU and mount from their calibration.
  [[nodiscard]] std::vector<InertialFinding> inertial_findings() const;

 private:
  [[nodiscard]] NavigationEstimate initialize(const Frame& frame, const FrameInterval& interval,
                                              const SensorReadings& readings);
  [[nodiscard]] std::optional<CameraRest> rest(const Frame& frame,
                                               const FrameInterval& interval) const;
  [[nodiscard]] Verdict verdict(const FrameInterval& interval) const;
  void restart_if_contradictory(Timestamp stamp);
  void restart_if_lost(Timestamp stamp);
  void restart(Timestamp stamp);
  [[nodiscard]] std::optional<Eigen::Vector3d> image_rate(
      const std::vector<FeatureObservation>& features);
  [[nodiscard]] std::optional<KeyframeView> align_to_ground(const Frame& frame,
                                                            const FrameInterval& interval,
                                                            const SensorReadings& readings);
  void take_ground_keyframe();
  void take_keyframe(const Frame& frame);
  void keep_reference();
  void lose_reference();
  void forget_lost_reference();
  [[nodiscard]] Matrix6d mount_covariance() const;
  [[nodiscard]] bool relocalize(const Frame& frame);
  [[nodiscard]] Matrix6d unmeasured_covariance(Timestamp stamp) const;
  [[nodiscard]] Matrix6d pose_covariance(Timestamp stamp) const;
  [[nodiscard]] NavigationEstimate answer(const Frame& frame, Verdict verdict,
                                          bool new_keyframe) const;

  RigidTransform body_from_camera_;
  double focal_px_;
  double max_unmeasured_s_;
  double rest_depth_m_;  // of the scene, for the velocity sigma at rest before any point is known
  KeyframeFeatures features_;
  KeyframeNavigator flow_;
  SlidingWindow window_;
  std::int64_t reference_id_ = -1;
  // Reference keyframe before a restart, with the covariance of its pose, order of
  // `origin_covariance_`; until it is found again.
  struct LostReference {
    KeyframeMap map;
    Matrix6d covariance;
  };
  std::optional<LostReference> lost_reference_;
  std::vector<FeatureObservation> previous_features_;
  std::optional<InertialFinding> contradiction_;  // with a prior, the latest
  Eigen::Quaterniond world_from_keyframe_;        // camera
  Eigen::Vector3d initial_position_m_ = Eigen::Vector3d::Zero();
  Timestamp imu_known_until_;
  Timestamp first_stamp_;
  Timestamp previous_;
  Timestamp last_;
  Timestamp last_measured_;
  Matrix6d origin_covariance_;  // pose of the window's first frame, (translation, rotation) in W
  double rate_sigma_rad_s_;     // by the gyroscope with an unknown bias
  bool has_flow_keyframe_ = false;  // the flow has taken the present frame
  double unmeasured_speed_m_s_;     // sigma without an initialization
};

}  // namespace stillkite
