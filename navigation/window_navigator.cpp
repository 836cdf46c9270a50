#include "navigation/window_navigator.hpp"

#include <algorithm>
#include <cmath>

#include "navigation/assumptions.hpp"
#include "navigation/estimate_parts.hpp"
#include "navigation/imu_samples.hpp"
#include "navigation/stop_watch.hpp"

namespace stillkite {
namespace {

ImuNoise imu_noise(const FusionConfig& config) {
  return {.gyro_density = config.gyro_density,
          .accel_density = config.accel_density,
          .gyro_bias_walk = config.gyro_bias_walk,
          .accel_bias_walk = config.accel_bias_walk};
}

InertialPriors inertial_priors(const NavigatorConfig& config) {
  InertialPriors priors;
  priors.gyro_bias_rad_s = config.sensors.gyro_bias_sigma_rad_s;
  return priors;
}

}  // namespace

WindowNavigator::WindowNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                                 const NavigatorConfig& config, const InitialState& initial)
    : body_from_camera_(body_from_camera),
      world_from_initial_(initial.world_from_body * body_from_camera),
      initial_tilt_sigma_rad_(config.initial_tilt_sigma_rad),
      features_(camera, config.lens_sigma_px),
      window_({.imu_from_camera = body_from_camera}, initial.world_from_body,
              imu_noise(config.fusion), inertial_priors(config)) {}

NavigationEstimate WindowNavigator::step(const Frame& frame, const FrameInterval& interval,
                                         const SensorReadings& readings) {
  StopWatch watch;
  if (interval.rejection == Verdict::first_frame) return initialize(frame);
  if (frame.stamp <= last_) return answer(frame, Verdict::time_gap, {}, false);
  // 1. Track the features of the latest keyframe.
  const bool is_image_usable = interval.rejection != Verdict::frozen;
  const std::vector<FeatureObservation> features =
      is_image_usable ? features_.track(frame) : std::vector<FeatureObservation>();
  const double flow_ms = watch.lap_ms();
  // 2. Predict by the IMU; estimate all states and points of the window.
  const std::vector<ImuSample> samples = imu_samples(readings.inertial, last_, frame.stamp);
  window_.add_frame(frame.stamp, samples, features);
  last_ = frame.stamp;
  // 3. Replace the keyframe if its features leave the view or show parallax.
  const Eigen::Quaterniond world_from_camera =
      window_.state().world_from_imu.rotation * body_from_camera_.rotation;
  const bool new_keyframe =
      is_image_usable &&
      features_.needs_keyframe(world_from_keyframe_.conjugate() * world_from_camera);
  const Verdict frame_verdict = verdict(interval);
  NavigationEstimate out = answer(frame, frame_verdict, samples, new_keyframe);
  if (new_keyframe) {
    window_.take_keyframe(features_.take_keyframe(frame));
    world_from_keyframe_ = world_from_camera;
  }
  out.stage_ms = {0, flow_ms, watch.lap_ms(), 0};
  return out;
}

NavigationEstimate WindowNavigator::initialize(const Frame& frame) {
  first_ = last_ = frame.stamp;
  world_from_keyframe_ = world_from_initial_.rotation;
  window_.add_frame(frame.stamp, {}, {});
  window_.take_keyframe(features_.take_keyframe(frame));
  return answer(frame, Verdict::first_frame, {}, true);
}

// Before the initialization velocity and scale are not observable.
Verdict WindowNavigator::verdict(const FrameInterval& interval) const {
  constexpr int kMinPoints = 12;
  if (interval.rejection) return *interval.rejection;
  if (!window_.is_initialized()) return Verdict::ill_conditioned;
  return window_.inlier_points() >= kMinPoints ? Verdict::ok : Verdict::too_few_inliers;
}

NavigationEstimate WindowNavigator::answer(const Frame& frame, Verdict frame_verdict,
                                           const std::vector<ImuSample>& samples,
                                           bool new_keyframe) const {
  using Index = InertialIndex;
  const InertialState& state = window_.state();
  const RigidTransform& imu_from_camera = window_.extrinsics().imu_from_camera;
  const Eigen::Matrix3d R = state.world_from_imu.rotation.toRotationMatrix();
  // means over the interval, by the IMU
  double dt_s = 0;
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : samples) {
    dt_s += sample.dt_s;
    rate += sample.dt_s * (sample.angular_rate_rad_s - state.gyro_bias_rad_s);
    force += sample.dt_s * (sample.specific_force_m_s2 - state.accel_bias_m_s2);
  }
  if (dt_s > 0) {
    rate /= dt_s;
    force /= dt_s;
  }
  const Eigen::Matrix3d R_middle = R * so3_exp(-0.5 * dt_s * rate).toRotationMatrix();
  const Eigen::Vector3d acceleration = R_middle * force + gravity_in_world();
  Eigen::Vector3d velocity =
      state.velocity_in_world_m_s + R_middle * rate.cross(imu_from_camera.translation);
  if (dt_s > 0) velocity -= 0.5 * dt_s * acceleration;
  const Eigen::Matrix3d camera_from_world =
      (R_middle * imu_from_camera.rotation.toRotationMatrix()).transpose();
  const Eigen::Matrix3d camera_from_imu = imu_from_camera.rotation.conjugate().toRotationMatrix();

  EstimateParts parts{.verdict = frame_verdict,
                      .source = EstimateSource::fused,
                      .camera = {.pose = {state.world_from_imu * body_from_camera_, {}},
                                 .scale = ScaleSource::none,
                                 .scale_stamp = frame.stamp},
                      .world_from_initial_camera = world_from_initial_,
                      .twist_in_camera = {camera_from_world * velocity, camera_from_imu * rate},
                      .velocity_in_world_m_s = velocity,
                      .quality = {.flow_vectors = features_.found_count()},
                      .new_keyframe = new_keyframe};
  Matrix6d& pose_covariance = parts.camera.pose.covariance;
  if (window_.is_initialized()) {
    parts.camera.scale = ScaleSource::imu;
    const SlidingWindow::Matrix15d& P = window_.covariance();
    // (translation, rotation) in the world
    Matrix6d J = Matrix6d::Zero();
    J.topRightCorner<3, 3>().setIdentity();
    J.bottomLeftCorner<3, 3>() = R;
    pose_covariance = J * P.topLeftCorner<6, 6>() * J.transpose();
    parts.twist_covariance.topLeftCorner<3, 3>() =
        camera_from_world * P.block<3, 3>(Index::kVelocity, Index::kVelocity) *
        camera_from_world.transpose();
    parts.twist_covariance.bottomRightCorner<3, 3>() =
        camera_from_imu * P.block<3, 3>(Index::kGyroBias, Index::kGyroBias) *
        camera_from_imu.transpose();
    const double density = window_.window().frames.back().imu.noise().gyro_density;
    if (dt_s > 0) {
      parts.twist_covariance.diagonal().tail<3>().array() += density * density / dt_s;
    }
  } else {
    const double t_s = seconds_between(first_, frame.stamp);
    const double tilt = initial_tilt_sigma_rad_ * initial_tilt_sigma_rad_;
    pose_covariance.diagonal() << Eigen::Vector3d::Constant(kExactVariance), tilt, tilt,
        kExactVariance;
    const double height = world_from_initial_.translation.z();
    const double way = kInitialSpeedSigma_heights_s * height * t_s;
    const double turn = kInitialRateSigma_rad_s * t_s;
    pose_covariance.diagonal().head<3>().array() += way * way;
    pose_covariance.diagonal().tail<3>().array() += turn * turn;
    parts.twist_covariance.diagonal()
        << Eigen::Vector3d::Constant(std::pow(kInitialSpeedSigma_heights_s * height, 2)),
        Eigen::Vector3d::Constant(std::pow(kInitialRateSigma_rad_s, 2));
  }
  return make_estimate(frame, body_from_camera_, parts);
}

}  // namespace stillkite
