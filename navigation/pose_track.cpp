#include "navigation/pose_track.hpp"

#include <algorithm>
#include <cmath>

#include "navigation/assumptions.hpp"

namespace stillkite {

PoseTrack::PoseTrack(const RigidTransform& body_from_camera, const NavigatorConfig& config,
                     const InitialState& initial)
    : body_from_camera_(body_from_camera),
      config_(config),
      filter_(config.filter),
      gyro_bias_(config.sensors.gyro_bias_sigma_rad_s) {
  const double tilt_variance = config.initial_tilt_sigma_rad * config.initial_tilt_sigma_rad;
  keyframe_.pose.world_from_camera = initial.world_from_body * body_from_camera;
  keyframe_.pose.covariance.diagonal() << kExactVariance, kExactVariance, kExactVariance,
      tilt_variance, tilt_variance, kExactVariance;
  keyframe_.scale = initial.scale;
}

void PoseTrack::initialize(const SensorReadings& readings, Timestamp now) {
  keyframe_.scale_stamp = now;
  const Eigen::Quaterniond& attitude = keyframe_.pose.world_from_camera.rotation;
  keyframe_ = apply_readings(keyframe_, camera_readings(readings, body_from_camera_, attitude),
                             config_.sensors, now);
  camera_ = keyframe_.pose;
  world_from_initial_ = camera_.world_from_camera;
  filter_.initialize(camera_.world_from_camera,
                     kInitialSpeedSigma_heights_s * camera_.world_from_camera.translation.z(),
                     kInitialRateSigma_rad_s);
  take_keyframe();
}

void PoseTrack::predict(double dt_s, const SensorReadings& readings) {
  has_jumped_ = false;
  const double max_gap_s = config_.trust.max_gap_s;
  const double predicted_s = std::clamp(max_gap_s - unmeasured_s_, 0.0, dt_s);
  const auto predict_filters = [&](double by_s) {
    for_each_filter([&](MultipleModelFilter& filter) { filter.predict(by_s); });
  };
  if (predicted_s > 0) predict_filters(predicted_s);
  if (predicted_s < dt_s) {
    if (unmeasured_s_ <= max_gap_s) reset_twist();
    predict_filters(dt_s - predicted_s);
  }
  if (filter_.pose().translation.z() <
      kMinHeightRatio * keyframe_.pose.world_from_camera.translation.z()) {
    reset_twist();
  }
  if (readings.mean_angular_rate_in_body_rad_s) {
    update_rate(*readings.mean_angular_rate_in_body_rad_s, dt_s);
  } else {
    gyro_bias_.stop();
  }
  unmeasured_s_ += dt_s;
  since_keyframe_s_ += dt_s;
}

void PoseTrack::for_each_filter(auto&& apply) {
  apply(filter_);
  if (dead_reckoning_) apply(*dead_reckoning_);
}

void PoseTrack::update_rate(const Eigen::Vector3d& mean_rate_in_body_rad_s, double dt_s) {
  const Eigen::Vector3d rate = body_from_camera_.rotation.conjugate() * mean_rate_in_body_rad_s;
  const double sigma = config_.sensors.gyro_sigma_rad_s;
  gyro_bias_.integrate(rate, dt_s, sigma);
  const Eigen::Matrix3d covariance =
      sigma * sigma * Eigen::Matrix3d::Identity() + gyro_bias_.covariance();
  for_each_filter([&](MultipleModelFilter& filter) {
    filter.update_rate(rate - gyro_bias_.mean_rad_s(), covariance);
  });
  if (dead_reckoning_) gyro_only_s_ += dt_s;
}

// By the rotation to the keyframe, with errors of the lens and the ground.
void PoseTrack::update_gyro_bias(const ChainedPose& chained) {
  const Eigen::Matrix3d R = chained.camera.world_from_camera.rotation.toRotationMatrix();
  const Eigen::Matrix3d covariance =
      (chained.relative_covariance + chained.common_covariance).bottomRightCorner<3, 3>();
  gyro_bias_.update(chained.keyframe_from_camera.rotation, R.transpose() * covariance * R);
}

// Holds the position; the former velocity becomes its standard deviation.
void PoseTrack::reset_twist() {
  const Matrix6d covariance = filter_.twist_covariance();
  const Twist twist = filter_.twist_in_camera();
  const double min_height_m = kMinHeightRatio * keyframe_.pose.world_from_camera.translation.z();
  const double height_correction_m = std::max(0.0, min_height_m - filter_.pose().translation.z());
  for_each_filter([&](MultipleModelFilter& filter) {
    filter.transform_world({Eigen::Quaterniond::Identity(), {0, 0, height_correction_m}});
    filter.reset_twist(
        twist.velocity_m_s.norm() + std::sqrt(covariance.diagonal().head<3>().maxCoeff()),
        twist.angular_rate_rad_s.norm() + std::sqrt(covariance.diagonal().tail<3>().maxCoeff()));
  });
}

MultipleModelFilter PoseTrack::filter_after(const PlaneAlignment& alignment) const {
  MultipleModelFilter updated = filter_;
  const ChainedPose chained = chain(keyframe_.pose, alignment, config_.levelling);
  update_filter(updated, chained, chained.relative_covariance, alignment);
  return updated;
}

void PoseTrack::update_filter(MultipleModelFilter& filter, const ChainedPose& chained,
                              const Matrix6d& covariance, const PlaneAlignment& alignment) const {
  const RigidTransform& world_from_keyframe = keyframe_.pose.world_from_camera;
  Twist assumed = Twist::from_vector(alignment.shutter.current_twist);
  assumed.velocity_m_s *= world_from_keyframe.translation.z();
  filter.update(world_from_keyframe * chained.keyframe_from_camera, covariance, assumed,
                chained.camera_by_twist);
}

// Change of the measured pose with its stamp, from the measurement before: the predicted velocity
// may still be unknown.
Vector6d PoseTrack::measured_rate(const ChainedPose& chained) const {
  const RigidTransform measured = keyframe_.pose.world_from_camera * chained.keyframe_from_camera;
  const RigidTransform& predicted = filter_.pose();
  const Twist twist = filter_.twist_in_camera();
  Vector6d rate;
  rate << predicted.rotation * twist.velocity_m_s +
              (measured.translation - predicted.translation) / unmeasured_s_,
      predicted.rotation * twist.angular_rate_rad_s +
          so3_log(measured.rotation * predicted.rotation.conjugate()) / unmeasured_s_;
  return rate;
}

void PoseTrack::update(const PlaneAlignment& alignment, const SensorReadings& readings,
                       Timestamp now, double stamp_sigma_s) {
  correct_keyframe(alignment, readings, now);
  const RigidTransform& world_from_keyframe = keyframe_.pose.world_from_camera;
  const ChainedPose chained = chain(keyframe_.pose, alignment, config_.levelling);
  const Vector6d by_stamp = stamp_sigma_s * measured_rate(chained);
  const Matrix6d covariance = chained.relative_covariance + by_stamp * by_stamp.transpose();
  has_jumped_ = is_discontinuity(chained, stamp_sigma_s);
  if (has_jumped_) {  // the images measure the position, not the velocity
    twist_before_jump_ = filter_.twist_in_camera();
    filter_.inflate_position_covariance(twist_before_jump_.velocity_m_s.norm() *
                                        config_.trust.max_gap_s);
    reset_twist();
  }
  update_filter(filter_, chained, covariance, alignment);
  camera_ = chained.camera;
  camera_.covariance += (filter_.noise_variance_ratio() - 1) * chained.relative_covariance;
  levelled_from_filter_ = chained.keyframe.world_from_camera * world_from_keyframe.inverse();
  covariance_offset_ = camera_.covariance - filter_.pose_covariance();
  dead_reckoning_.reset();
  update_gyro_bias(chained);
  common_twist_covariance_ = common_twist_covariance(chained);
  unmeasured_s_ = 0;
}

// After a jump the velocity is unknown: the one before it, with the standard deviations of the
// reset.
TwistEstimate PoseTrack::twist() const {
  if (has_jumped_) return {twist_before_jump_, filter_.twist_covariance()};
  return {filter_.mean_twist_in_camera(),
          filter_.mean_twist_covariance() + common_twist_covariance_};
}

// The errors are proportional to the motion since the keyframe: those of a constant twist.
Matrix6d PoseTrack::common_twist_covariance(const ChainedPose& chained) const {
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() =
      chained.camera.world_from_camera.rotation.conjugate().toRotationMatrix() / since_keyframe_s_;
  return J * chained.common_covariance * J.transpose();
}

// Images are missing or were repeated without a trace in the stamps: a displacement of up to
// `trust.max_gap_s` at the former velocity. Expected once an hour. The error by the stamp is that
// of the predicted velocity: the measured one would contain the discontinuity.
bool PoseTrack::is_discontinuity(const ChainedPose& chained, double stamp_sigma_s) const {
  constexpr double kMeanInterval_s = 3600;
  const Eigen::Vector3d position =
      (keyframe_.pose.world_from_camera * chained.keyframe_from_camera).translation;
  const double speed_m_s = filter_.twist_in_camera().velocity_m_s.norm();
  const double by_stamp_m = stamp_sigma_s * speed_m_s;
  Eigen::Matrix3d covariance = chained.relative_covariance.topLeftCorner<3, 3>();
  covariance.diagonal().array() += by_stamp_m * by_stamp_m;
  const double discontinuous =
      filter_.position_log_likelihood(position, covariance, speed_m_s * config_.trust.max_gap_s);
  return discontinuous + std::log(unmeasured_s_ / kMeanInterval_s) >
         filter_.position_log_likelihood(position, covariance, 0);
}

// The alignment's height ratio and rotation transfer a reading at this frame to the keyframe.
void PoseTrack::correct_keyframe(const PlaneAlignment& alignment, const SensorReadings& readings,
                                 Timestamp now) {
  if (!readings.height_m && !readings.attitude) return;
  const ChainedPose chained = chain(keyframe_.pose, alignment, config_.levelling);
  const RigidTransform& camera = chained.camera.world_from_camera;
  CameraReadings at_keyframe = camera_readings(readings, body_from_camera_, camera.rotation);
  if (at_keyframe.height_m) {
    *at_keyframe.height_m *=
        chained.keyframe.world_from_camera.translation.z() / camera.translation.z();
  }
  if (at_keyframe.attitude) {
    at_keyframe.attitude =
        *at_keyframe.attitude * chained.keyframe_from_camera.rotation.conjugate();
  }
  const ScaledPose corrected = apply_readings(keyframe_, at_keyframe, config_.sensors, now);
  // transform the filter's world accordingly
  const RigidTransform& from = keyframe_.pose.world_from_camera;
  const RigidTransform& to = corrected.pose.world_from_camera;
  const double factor = to.translation.z() / from.translation.z();
  if (keyframe_.scale == ScaleSource::none) {  // lengths were in initial heights
    world_from_initial_.translation *= factor;
    keyframe_twist_.velocity_m_s *= factor;
  }
  filter_.rescale_world(factor);
  filter_.transform_world(to * RigidTransform{from.rotation, factor * from.translation}.inverse());
  keyframe_ = corrected;
}

void PoseTrack::stand_still(const FrameInterval& interval, const SensorReadings& readings,
                            Timestamp now) {
  has_jumped_ = false;
  const StandstillSigma& sigma = interval.standstill.value();
  const double height_m = filter_.pose().translation.z();
  for_each_filter([&](MultipleModelFilter& filter) {
    filter.reset_twist(sigma.rate_rad_s * height_m, sigma.rate_rad_s);
  });
  common_twist_covariance_.setZero();
  since_keyframe_s_ += interval.dt_s;
  unmeasured_s_ = 0;
  coast(readings, now);
  const double shift_sigma_m = sigma.rotation_rad * height_m;
  camera_.covariance.diagonal().head<3>().array() += shift_sigma_m * shift_sigma_m;
  camera_.covariance.diagonal().tail<3>().array() += sigma.rotation_rad * sigma.rotation_rad;
}

// A rejection selects images of a changed motion: the likelihoods of the accepted ones before it
// are no evidence on its acceleration.
void PoseTrack::coast_over_rejection(const SensorReadings& readings, Timestamp now) {
  for_each_filter([](MultipleModelFilter& filter) { filter.allow_acceleration(); });
  coast(readings, now);
}

void PoseTrack::coast(const SensorReadings& readings, Timestamp now) {
  if (!dead_reckoning_) {
    dead_reckoning_ = filter_;
    dead_reckoning_offset_ = covariance_offset_;
    gyro_only_s_ = 0;
  }
  camera_ = {levelled_from_filter_ * filter_.pose(),
             dead_reckoning_offset_ + dead_reckoning_->pose_covariance()};
  // the bias is constant: its error grows with the time, that of the rate with its root
  const Eigen::Matrix3d R = camera_.world_from_camera.rotation.toRotationMatrix();
  camera_.covariance.bottomRightCorner<3, 3>() +=
      gyro_only_s_ * gyro_only_s_ * R * gyro_bias_.covariance() * R.transpose();
  if (keyframe_.scale == ScaleSource::none)
    return;  // no alignment transfers a scale to the keyframe
  ScaledPose current = keyframe_;
  current.pose = camera_;
  const ScaledPose corrected = apply_readings(
      current, camera_readings(readings, body_from_camera_, camera_.world_from_camera.rotation),
      config_.sensors, now);
  camera_ = corrected.pose;
  keyframe_.rejected_heights = corrected.rejected_heights;
  keyframe_.rejected_reading_m = corrected.rejected_reading_m;
  if (corrected.scale == keyframe_.scale) keyframe_.scale_stamp = corrected.scale_stamp;
}

void PoseTrack::take_keyframe() {
  // move the filter to the levelled world
  const RigidTransform levelled = camera_.world_from_camera * filter_.pose().inverse();
  for_each_filter([&](MultipleModelFilter& filter) { filter.transform_world(levelled); });
  keyframe_.pose = camera_;
  keyframe_twist_ = filter_.twist_in_camera();
  levelled_from_filter_ = {};
  since_keyframe_s_ = 0;
  gyro_bias_.start_at(Eigen::Quaterniond::Identity(), Eigen::Matrix3d::Zero());
  // alignments do not observe the position of an unmeasured keyframe
  if (unmeasured_s_ > 0) filter_.set_pose_as_origin();
  covariance_offset_ = camera_.covariance - filter_.pose_covariance();
}

}  // namespace stillkite
