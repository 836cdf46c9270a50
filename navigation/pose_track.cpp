#include "navigation/pose_track.hpp"

#include <algorithm>
#include <cmath>

#include "navigation/assumptions.hpp"

namespace stillkite {

PoseTrack::PoseTrack(const RigidTransform& body_from_camera, const NavigatorConfig& config,
                     const InitialState& initial)
    : body_from_camera_(body_from_camera), config_(config), filter_(config.filter) {
  const double tilt_variance = config.initial_tilt_sigma_rad * config.initial_tilt_sigma_rad;
  keyframe_.pose.world_from_camera = initial.world_from_body * body_from_camera;
  keyframe_.pose.covariance.diagonal() << kExact, kExact, kExact, tilt_variance, tilt_variance,
      kExact;
  keyframe_.scale = initial.scale;
}

void PoseTrack::start(const SensorReadings& readings, Timestamp now) {
  keyframe_.scale_stamp = now;
  const Eigen::Quaterniond& attitude = keyframe_.pose.world_from_camera.rotation;
  keyframe_ = with_readings(keyframe_, of_camera(readings, body_from_camera_, attitude),
                            config_.sensors, now);
  camera_ = keyframe_.pose;
  world_from_start_ = camera_.world_from_camera;
  filter_.start(camera_.world_from_camera,
                kAnySpeed_heights_s * camera_.world_from_camera.translation.z(), kAnyRate_rad_s);
  take_keyframe();
}

void PoseTrack::predict(double dt_s, const SensorReadings& readings) {
  has_leapt_ = false;
  const double max_gap_s = config_.trust.max_gap_s;
  const double with_speed_s = std::clamp(max_gap_s - blind_s_, 0.0, dt_s);
  if (with_speed_s > 0) filter_.predict(with_speed_s);
  if (with_speed_s < dt_s) {
    if (blind_s_ <= max_gap_s) forget_speed();
    filter_.predict(dt_s - with_speed_s);
  }
  if (filter_.pose().translation.z() < kLowest * keyframe_.pose.world_from_camera.translation.z()) {
    forget_speed();
  }
  if (readings.mean_angular_rate_in_body_rad_s) {
    const Eigen::Vector3d rate =
        body_from_camera_.rotation.conjugate() * *readings.mean_angular_rate_in_body_rad_s;
    const double sigma = config_.sensors.gyro_sigma_rad_s;
    filter_.update_rate(rate, sigma * sigma * Eigen::Matrix3d::Identity());
  }
  blind_s_ += dt_s;
}

// The camera stays where it is, as uncertain as if it had gone on.
void PoseTrack::forget_speed() {
  const Matrix6d known = filter_.twist_covariance();
  const Twist twist = filter_.twist_in_camera();
  const double lowest_m = kLowest * keyframe_.pose.world_from_camera.translation.z();
  const double too_low_m = std::max(0.0, lowest_m - filter_.pose().translation.z());
  filter_.transform_world({Eigen::Quaterniond::Identity(), {0, 0, too_low_m}});
  filter_.forget_speed(
      twist.velocity_m_s.norm() + std::sqrt(known.diagonal().head<3>().maxCoeff()),
      twist.angular_rate_rad_s.norm() + std::sqrt(known.diagonal().tail<3>().maxCoeff()));
}

MotionFilter PoseTrack::filter_after(const PlaneAlignment& alignment) const {
  MotionFilter informed = filter_;
  tell(informed, chain(keyframe_.pose, alignment, config_.levelling), alignment);
  return informed;
}

void PoseTrack::tell(MotionFilter& filter, const ChainedPose& chained,
                     const PlaneAlignment& alignment) const {
  const RigidTransform& world_from_keyframe = keyframe_.pose.world_from_camera;
  Twist assumed = Twist::from_vector(alignment.shutter.current_twist);
  assumed.velocity_m_s *= world_from_keyframe.translation.z();
  filter.update(world_from_keyframe * chained.keyframe_from_camera, chained.relative_covariance,
                assumed, chained.camera_by_twist);
}

void PoseTrack::accept(const PlaneAlignment& alignment, const SensorReadings& readings,
                       Timestamp now) {
  correct_keyframe(alignment, readings, now);
  const RigidTransform& world_from_keyframe = keyframe_.pose.world_from_camera;
  const ChainedPose chained = chain(keyframe_.pose, alignment, config_.levelling);
  const double leap_m = leap_to(chained);
  has_leapt_ = leap_m > 0;
  if (has_leapt_) {  // where it is the images show; how fast they do not
    filter_.doubt_place(leap_m);
    forget_speed();
  }
  tell(filter_, chained, alignment);
  camera_ = chained.camera;
  level_from_filter_ = chained.keyframe.world_from_camera * world_from_keyframe.inverse();
  beyond_filter_ = camera_.covariance - filter_.pose_covariance();
  blind_s_ = 0;
}

// 0: no further than a drone may have been accelerated.
double PoseTrack::leap_to(const ChainedPose& chained) const {
  constexpr double kMost_m_s2 = 50;
  constexpr double kSigmas = 5;
  if (keyframe_.scale == ScaleSource::none) return 0;
  const RigidTransform seen = keyframe_.pose.world_from_camera * chained.keyframe_from_camera;
  const double off_m = (seen.translation - filter_.pose().translation).norm();
  const double variance_m2 =
      (filter_.pose_covariance() + chained.relative_covariance).topLeftCorner<3, 3>().trace();
  const double most_m =
      std::max(kMost_m_s2 * blind_s_ * blind_s_, kSigmas * std::sqrt(variance_m2));
  return off_m > most_m ? off_m : 0;
}

// A reading at this frame says what it would have been at the keyframe: the alignment knows the
// ratio of the heights and the turn.
void PoseTrack::correct_keyframe(const PlaneAlignment& alignment, const SensorReadings& readings,
                                 Timestamp now) {
  if (!readings.height_m && !readings.attitude) return;
  const ChainedPose chained = chain(keyframe_.pose, alignment, config_.levelling);
  const RigidTransform& camera = chained.camera.world_from_camera;
  CameraReadings at_keyframe = of_camera(readings, body_from_camera_, camera.rotation);
  if (at_keyframe.height_m) {
    *at_keyframe.height_m *=
        chained.keyframe.world_from_camera.translation.z() / camera.translation.z();
  }
  if (at_keyframe.attitude) {
    at_keyframe.attitude =
        *at_keyframe.attitude * chained.keyframe_from_camera.rotation.conjugate();
  }
  const ScaledPose corrected = with_readings(keyframe_, at_keyframe, config_.sensors, now);
  // the filter's world follows
  const RigidTransform& from = keyframe_.pose.world_from_camera;
  const RigidTransform& to = corrected.pose.world_from_camera;
  const double factor = to.translation.z() / from.translation.z();
  if (keyframe_.scale == ScaleSource::none) {  // all of it was in initial heights
    world_from_start_.translation *= factor;
    keyframe_twist_.velocity_m_s *= factor;
  }
  filter_.stretch_world(factor);
  filter_.transform_world(to * RigidTransform{from.rotation, factor * from.translation}.inverse());
  keyframe_ = corrected;
}

void PoseTrack::coast(const SensorReadings& readings, Timestamp now) {
  camera_ = {level_from_filter_ * filter_.pose(), beyond_filter_ + filter_.pose_covariance()};
  if (keyframe_.scale == ScaleSource::none) return;  // no alignment to hand a scale back by
  ScaledPose known = keyframe_;
  known.pose = camera_;
  const ScaledPose corrected = with_readings(
      known, of_camera(readings, body_from_camera_, camera_.world_from_camera.rotation),
      config_.sensors, now);
  camera_ = corrected.pose;
  keyframe_.refused_heights = corrected.refused_heights;
  keyframe_.refused_m = corrected.refused_m;
  if (corrected.scale == keyframe_.scale) keyframe_.scale_stamp = corrected.scale_stamp;
}

void PoseTrack::take_keyframe() {
  // the world as the filter sees it becomes the levelled one
  filter_.transform_world(camera_.world_from_camera * filter_.pose().inverse());
  keyframe_.pose = camera_;
  keyframe_twist_ = filter_.twist_in_camera();
  level_from_filter_ = {};
  // where a keyframe is that nothing measured, no alignment to it tells
  if (blind_s_ > 0) filter_.take_as_origin();
  beyond_filter_ = camera_.covariance - filter_.pose_covariance();
}

}  // namespace stillkite
