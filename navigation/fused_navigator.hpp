#pragma once

#include <optional>
#include <vector>

#include "estimation/fusion/fusion_filter.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/fused_velocity.hpp"
#include "navigation/keyframe_navigator.hpp"
#include "navigation/landmark_selection.hpp"
#include "navigation/reference_navigator.hpp"

namespace stillkite {

/// Both estimators on the same frames and one filter that knows more than either: the flow's
/// velocity has a scale but drifts, the reference's features do not drift but have none
/// (docs/fusion.md).
class FusedNavigator {
 public:
  FusedNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                 const NavigatorConfig& config, const InitialState& initial);

  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings);

  /// The reference's features.
  [[nodiscard]] const std::vector<WeightedFlow>& flow_vectors() const {
    return reference_.flow_vectors();
  }

 private:
  // What told something in this frame.
  struct Seen {
    bool ground = false;
    bool landmarks = false;
  };

  [[nodiscard]] Eigen::Quaterniond guessed_attitude(const NavigationEstimate& flow) const;
  void predict(const SensorReadings& readings, Timestamp now, const NavigationEstimate& reference);
  [[nodiscard]] InertialStep uncovered_step(const SensorReadings& readings, double dt_s,
                                            const NavigationEstimate& reference) const;
  void update_rotation(const NavigationEstimate& reference);
  void set_angular_rate(const NavigationEstimate& estimate);
  void update_from_sensors(const SensorReadings& readings, Timestamp now);
  [[nodiscard]] Seen update_from_images(const NavigationEstimate& flow,
                                        const NavigationEstimate& reference, bool is_spoiled);
  [[nodiscard]] bool is_consistent_relocalization(const FeatureBearings& bearings,
                                                  const std::vector<unsigned char>& inliers,
                                                  const Eigen::Quaterniond& world_from_camera,
                                                  Timestamp now) const;
  void take_reference(bool on_first_reference);
  void reseat_anchor();
  void judge_ground(bool on_first_reference);
  [[nodiscard]] bool update_from_plane();
  [[nodiscard]] double lens_ratio() const;
  [[nodiscard]] FlowHints flow_hints() const;
  [[nodiscard]] double correlated_frames() const;
  [[nodiscard]] bool update_from_landmarks(bool on_first_reference);
  [[nodiscard]] MotionEstimate motion_since_reference(const MotionEstimate& by_reference) const;
  [[nodiscard]] Eigen::Quaterniond world_from_half_way() const;
  [[nodiscard]] VectorEstimate mean_velocity(const NavigationEstimate& flow, bool flow_taken) const;
  [[nodiscard]] NavigationEstimate answer(const Frame& frame, Verdict verdict,
                                          const VectorEstimate& velocity_in_camera,
                                          const NavigationEstimate& reference) const;

  Camera camera_;
  RigidTransform body_from_camera_;
  Eigen::Quaterniond world_from_initial_;  // of the camera
  FusionConfig config_;
  SensorConfig sensors_;
  ScaleSource scale_;
  KeyframeNavigator flow_;
  ReferenceNavigator reference_;
  // in the flow's own world
  RigidTransform flow_from_camera_;
  RigidTransform flow_from_anchor_;  // at the reference frame
  ScaleSource flow_scale_;
  LandmarkSelection landmarks_;
  FusionFilter filter_;
  FusionMap home_;         // as it was when the first reference was left
  Timestamp scale_stamp_;  // when the metres were last told
  Timestamp last_;
  bool is_start_doubted_ = false;  // a sensor has measured its height since
  bool is_ground_flat_;
  bool has_relief_ = false;  // by the landmarks' heights
  int contrary_ = 0;         // frames in a row that showed otherwise
  bool has_gyro_ = false;    // since the last frame
  // means since the last frame
  double step_s_ = 0;  // the last interval
  Eigen::Vector3d rate_in_camera_rad_s_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rate_covariance_ = Eigen::Matrix3d::Zero();
};

}  // namespace stillkite
