#pragma once

#include <optional>

#include "estimation/ego_motion/gyro_bias.hpp"
#include "estimation/ego_motion/multiple_model_filter.hpp"
#include "estimation/plane/keyframe_pose.hpp"
#include "navigation/frame_interval.hpp"
#include "navigation/navigator_config.hpp"
#include "navigation/sensor_readings.hpp"
#include "navigation/sensor_update.hpp"

namespace stillkite {

/// Twist in camera with the covariance of (velocity, angular rate).
struct TwistEstimate {
  Twist twist;
  Matrix6d covariance;
};

/// Camera pose over time: a keyframe's pose, the alignments to it, and a filter that predicts
/// across frames without a measurement.
class PoseTrack {
 public:
  PoseTrack(const RigidTransform& body_from_camera, const NavigatorConfig& config,
            const InitialState& initial);

  /// Makes the first frame, at the initial pose, the keyframe.
  void initialize(const SensorReadings& readings, Timestamp now);

  /// Predicts by `dt_s` at constant velocity, with the gyro's angular rate if there is one. After
  /// `trust.max_gap_s` without a measurement the velocity is reset: the position is held while
  /// its covariance grows with the former velocity.
  void predict(double dt_s, const SensorReadings& readings);

  /// Updates the camera by this frame's alignment to the keyframe. `stamp_sigma_s`: standard
  /// deviation of `now`.
  void update(const PlaneAlignment& alignment, const SensorReadings& readings, Timestamp now,
              double stamp_sigma_s);

  /// Measures zero twist instead of a prediction and an alignment: the pose is held.
  void stand_still(const FrameInterval& interval, const SensorReadings& readings, Timestamp now);

  /// Keeps the prediction: this frame has no measurement.
  void coast(const SensorReadings& readings, Timestamp now);

  /// Coasts through an image that does not align: the acceleration may have changed.
  void coast_over_rejection(const SensorReadings& readings, Timestamp now);

  /// Sets the twist of a keyframe that was taken before the velocity was estimated.
  void set_keyframe_twist(const Twist& twist) { keyframe_twist_ = twist; }

  /// Makes this frame the keyframe, at its estimated pose.
  void take_keyframe();

  [[nodiscard]] const PoseEstimate& keyframe() const { return keyframe_.pose; }
  [[nodiscard]] const Twist& keyframe_twist() const { return keyframe_twist_; }
  /// Filter in the keyframe's world, before levelling.
  [[nodiscard]] const MultipleModelFilter& filter() const { return filter_; }
  /// Filter updated by this alignment, without changing the track.
  [[nodiscard]] MultipleModelFilter filter_after(const PlaneAlignment& alignment) const;
  [[nodiscard]] const PoseEstimate& camera() const { return camera_; }
  /// Mean twist over the last interval.
  [[nodiscard]] TwistEstimate twist() const;
  /// Camera pose at the first frame, rescaled with the world by the first height.
  [[nodiscard]] const RigidTransform& world_from_initial() const { return world_from_initial_; }
  /// True if the last frame's displacement is explained by missing or repeated images without a
  /// trace in the stamps. The velocity is then unknown.
  [[nodiscard]] bool has_jumped() const { return has_jumped_; }
  [[nodiscard]] ScaleSource scale() const { return keyframe_.scale; }
  [[nodiscard]] Timestamp scale_stamp() const { return keyframe_.scale_stamp; }

 private:
  void correct_keyframe(const PlaneAlignment& alignment, const SensorReadings& readings,
                        Timestamp now);
  [[nodiscard]] Vector6d measured_rate(const ChainedPose& chained) const;
  [[nodiscard]] Matrix6d common_twist_covariance(const ChainedPose& chained) const;
  [[nodiscard]] bool is_discontinuity(const ChainedPose& chained, double stamp_sigma_s) const;
  void reset_twist();
  void for_each_filter(auto&& apply);
  void update_rate(const Eigen::Vector3d& mean_rate_in_body_rad_s, double dt_s);
  void update_gyro_bias(const ChainedPose& chained);
  void update_filter(MultipleModelFilter& filter, const ChainedPose& chained,
                     const Matrix6d& covariance, const PlaneAlignment& alignment) const;

  RigidTransform body_from_camera_;
  NavigatorConfig config_;
  ScaledPose keyframe_;
  Twist keyframe_twist_;
  MultipleModelFilter filter_;
  GyroBias gyro_bias_;
  PoseEstimate camera_;
  RigidTransform world_from_initial_;
  RigidTransform levelled_from_filter_;                  // correction by the keyframe's levelling
  Matrix6d covariance_offset_ = Matrix6d::Zero();        // pose covariance that the filter lacks
  Matrix6d common_twist_covariance_ = Matrix6d::Zero();  // twist covariance that it lacks
  Twist twist_before_jump_;
  /// Filter since the last measurement: its position keeps the correlation with the velocity
  /// through keyframes taken meanwhile. `dead_reckoning_offset_`: as `covariance_offset_`.
  std::optional<MultipleModelFilter> dead_reckoning_;
  Matrix6d dead_reckoning_offset_ = Matrix6d::Zero();
  double gyro_only_s_ = 0;  ///< of that, with a gyroscope
  double since_keyframe_s_ = 0;
  double unmeasured_s_ = 0;  // since the last measurement
  bool has_jumped_ = false;
};

}  // namespace stillkite
