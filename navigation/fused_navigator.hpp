#pragma once

#include <optional>
#include <vector>

#include "estimation/fusion_filter.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/keyframe_navigator.hpp"
#include "navigation/reference_navigator.hpp"

namespace stillkite {

/// Both estimators on the same frames and one filter that knows more than either: the flow's
/// velocity has a scale but drifts, the reference's features do not drift but have none
/// (docs/fusion.md).
class FusedNavigator {
 public:
  FusedNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                 const NavigatorConfig& config, const InitialState& initial, Mode mode);

  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings);

  /// The reference's features.
  [[nodiscard]] const std::vector<WindowFlow>& windows() const { return reference_.windows(); }

 private:
  void predict(const SensorReadings& readings, Timestamp now, const NavigationEstimate& flow,
               const NavigationEstimate& reference);
  [[nodiscard]] InertialStep uncovered_step(const SensorReadings& readings, double dt_s,
                                            const NavigationEstimate& reference) const;
  [[nodiscard]] Eigen::Matrix3d rate_covariance(bool has_gyro, double dt_s,
                                                const NavigationEstimate& flow,
                                                const NavigationEstimate& reference) const;
  [[nodiscard]] bool follow_flow(const NavigationEstimate& flow, double dt_s);
  void judge_ground(const ReferenceReport& reference);
  [[nodiscard]] bool see_flow(const NavigationEstimate& flow);
  [[nodiscard]] bool see_landmarks();
  void choose_landmarks();
  [[nodiscard]] double feature_sigma() const;
  [[nodiscard]] NavigationEstimate answer(const Frame& frame, Verdict verdict) const;
  [[nodiscard]] static Eigen::Matrix3d any_rate_covariance();

  Camera camera_;
  RigidTransform body_from_camera_;
  FusionConfig config_;
  double readout_s_;
  ScaleSource scale_;
  KeyframeNavigator flow_;
  ReferenceNavigator reference_;
  FusionFilter filter_;
  Timestamp last_;
  std::optional<NavigationEstimate> last_flow_;  // where it was ok
  bool is_ground_flat_ = false;
  bool follows_flow_ = false;  // since the last frame, for want of an IMU
  Eigen::Vector3d rate_in_camera_rad_s_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rate_covariance_ = any_rate_covariance();
};

}  // namespace stillkite
