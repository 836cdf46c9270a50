#pragma once

#include "estimation/ego_motion/motion_filter.hpp"
#include "estimation/plane/keyframe_pose.hpp"
#include "navigation/navigator_config.hpp"
#include "navigation/sensor_readings.hpp"
#include "navigation/sensor_update.hpp"

namespace stillkite {

/// Where the camera is, from frame to frame: the pose of a keyframe, what alignments to it say of
/// the camera, and a filter that carries the motion on where they say nothing.
class PoseTrack {
 public:
  PoseTrack(const RigidTransform& body_from_camera, const NavigatorConfig& config,
            const InitialState& initial);

  /// At the first frame: the keyframe is the start.
  void start(const SensorReadings& readings, Timestamp now);

  /// Carries the motion on for `dt_s`; a gyro's rate tells the turn. What nothing has measured
  /// for longer than `trust.max_gap_s` is no speed any more: the camera then stays, and the
  /// covariance grows as if it had not.
  void predict(double dt_s, const SensorReadings& readings);

  /// The camera by this frame's alignment to the keyframe.
  void accept(const PlaneAlignment& alignment, const SensorReadings& readings, Timestamp now);

  /// The camera as predicted: this frame measured nothing.
  void coast(const SensorReadings& readings, Timestamp now);

  /// What the camera's motion must have been at a keyframe that was taken before it was known.
  void assume_keyframe_twist(const Twist& twist) { keyframe_twist_ = twist; }

  /// This frame, wherever it is, is the keyframe.
  void take_keyframe();

  [[nodiscard]] const PoseEstimate& keyframe() const { return keyframe_.pose; }
  [[nodiscard]] const Twist& keyframe_twist() const { return keyframe_twist_; }
  /// In the world as the keyframe, not yet levelled, sees it.
  [[nodiscard]] const MotionFilter& filter() const { return filter_; }
  /// The filter as it would be after this alignment.
  [[nodiscard]] MotionFilter filter_after(const PlaneAlignment& alignment) const;
  [[nodiscard]] const PoseEstimate& camera() const { return camera_; }
  /// Of the camera at the first frame; stretched with the world once a height is known.
  [[nodiscard]] const RigidTransform& world_from_start() const { return world_from_start_; }
  /// The last frame shows the camera further on than any drone is accelerated: images
  /// are missing whose time has not passed, or those before were sent again.
  [[nodiscard]] bool has_leapt() const { return has_leapt_; }
  [[nodiscard]] ScaleSource scale() const { return keyframe_.scale; }
  [[nodiscard]] Timestamp scale_stamp() const { return keyframe_.scale_stamp; }

 private:
  void correct_keyframe(const PlaneAlignment& alignment, const SensorReadings& readings,
                        Timestamp now);
  [[nodiscard]] double leap_to(const ChainedPose& chained) const;
  void forget_speed();
  void tell(MotionFilter& filter, const ChainedPose& chained,
            const PlaneAlignment& alignment) const;

  RigidTransform body_from_camera_;
  NavigatorConfig config_;
  ScaledPose keyframe_;
  Twist keyframe_twist_;
  MotionFilter filter_;
  PoseEstimate camera_;
  RigidTransform world_from_start_;
  RigidTransform level_from_filter_;           // the keyframe's levelling
  Matrix6d beyond_filter_ = Matrix6d::Zero();  // covariance of the pose that the filter is not told
  double blind_s_ = 0;                         // since the last measurement
  bool has_leapt_ = false;
};

}  // namespace stillkite
