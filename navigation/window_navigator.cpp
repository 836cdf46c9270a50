#include "navigation/window_navigator.hpp"

#include <algorithm>

#include "estimation/sliding_window/epipolar_rotation.hpp"
#include "estimation/sliding_window/reprojection_errors.hpp"
#include "flow/standstill_detector.hpp"
#include "navigation/assumptions.hpp"
#include "navigation/estimate_parts.hpp"
#include "navigation/imu_intervals.hpp"
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
  constexpr double kMinSigma_rad_s = 1e-6;  // a bias that is known exactly
  const SensorConfig& sensors = config.sensors;
  return {.gyro_bias_rad_s = std::max(kMinSigma_rad_s, sensors.gyro_bias_sigma_rad_s),
          .accel_bias_m_s2 = sensors.accel_bias_sigma_m_s2,
          .camera_rotation_rad = sensors.camera_rotation_sigma_rad,
          .lever_arm_m = sensors.lever_arm_sigma_m,
          .time_offset_s = sensors.time_offset_sigma_s};
}

std::optional<StartAboveGround> start_above_ground(const NavigatorConfig& config,
                                                   const InitialState& initial) {
  constexpr double kMaxHeightSigma_ratio = 0.3;  // else the scale is as good as unknown
  constexpr double kMinSlope_rad = 1e-6;
  if (initial.scale == ScaleSource::none) return std::nullopt;
  if (config.sensors.start_height_sigma_ratio > kMaxHeightSigma_ratio) return std::nullopt;
  const double height_m = initial.world_from_body.translation.z();
  StartAboveGround start{.world_from_imu = initial.world_from_body,
                         .height_sigma_m = config.sensors.start_height_sigma_ratio * height_m,
                         .tilt_sigma_rad = config.initial_tilt_sigma_rad,
                         .relief = GroundRelief(height_m)};
  if (config.levelling.enabled) {
    start.level_slope_rad = std::max(kMinSlope_rad, config.levelling.ground_slope_sigma_rad);
  }
  return start;
}

Matrix6d initial_covariance(const NavigatorConfig& config, const InitialState& initial) {
  Matrix6d covariance = kExactVariance * Matrix6d::Identity();
  covariance.diagonal().segment<2>(3).setConstant(config.initial_tilt_sigma_rad *
                                                  config.initial_tilt_sigma_rad);
  const auto start = start_above_ground(config, initial);
  if (start) covariance(2, 2) = start->height_sigma_m * start->height_sigma_m;
  return covariance;
}

// Height of the camera, where it is known.
double rest_depth_m(const InitialState& initial, const RigidTransform& body_from_camera) {
  constexpr double kUnknown_m = 10;
  if (initial.scale == ScaleSource::none) return kUnknown_m;
  return (initial.world_from_body * body_from_camera).translation.z();
}

}  // namespace

WindowNavigator::WindowNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                                 const NavigatorConfig& config, const InitialState& initial)
    : body_from_camera_(body_from_camera),
      focal_px_(camera.focal_x_px),
      max_unmeasured_s_(config.trust.max_gap_s),
      rest_depth_m_(rest_depth_m(initial, body_from_camera)),
      features_(camera, config.lens_sigma_px),
      flow_(camera, body_from_camera, config, initial),
      window_({.imu_from_camera = body_from_camera}, initial.world_from_body,
              imu_noise(config.fusion), inertial_priors(config),
              start_above_ground(config, initial)),
      origin_covariance_(initial_covariance(config, initial)),
      rate_sigma_rad_s_(config.sensors.gyro_bias_sigma_rad_s),
      unmeasured_speed_m_s_(kInitialSpeedSigma_heights_s * rest_depth_m_) {}

NavigationEstimate WindowNavigator::step(const Frame& frame, const FrameInterval& interval,
                                         const SensorReadings& readings) {
  StopWatch watch;
  if (interval.rejection == Verdict::first_frame) return initialize(frame, interval, readings);
  if (frame.stamp <= last_) return answer(frame, Verdict::time_gap, false);
  // 1. Track the features of the latest keyframe.
  const bool is_image_usable = interval.rejection != Verdict::frozen;
  const std::vector<FeatureObservation> features =
      is_image_usable ? features_.track(frame) : std::vector<FeatureObservation>();
  const std::optional<KeyframeView> ground = align_to_ground(frame, interval, readings);
  const double flow_ms = watch.lap_ms();
  // 2. Predict by the IMU; estimate all states and points of the window.
  const std::vector<ImuInterval> imu = imu_intervals(readings.inertial, imu_known_until_);
  if (!imu.empty()) imu_known_until_ = imu.back().to;
  const std::optional<CameraRest> camera_rest = rest(frame, interval);
  const bool was_initialized = window_.is_initialized();
  window_.add_frame(frame.stamp, imu, features, camera_rest, ground);
  if (!was_initialized && window_.is_initialized()) {
    origin_covariance_ = unmeasured_covariance(camera_rest ? camera_rest->since
                                                           : window_.window().frames.front().stamp);
    initial_position_m_ = window_.state().world_from_imu.translation;
  }
  previous_ = last_;
  last_ = frame.stamp;
  // 3. Without measurements for too long: initialize again.
  restart_if_contradictory(frame.stamp);
  const Verdict frame_verdict = verdict(interval);
  if (is_measured(frame_verdict)) last_measured_ = frame.stamp;
  restart_if_lost(frame.stamp);
  // 4. Replace the keyframe if its features leave the view or show parallax.
  const Eigen::Quaterniond world_from_camera =
      window_.state().world_from_imu.rotation * body_from_camera_.rotation;
  const bool has_tracks = !window_.window().tracks.empty();
  const bool new_keyframe =
      is_image_usable && (!has_tracks || features_.needs_keyframe(world_from_keyframe_.conjugate() *
                                                                  world_from_camera));
  const bool is_relocalized = new_keyframe && relocalize(frame);
  NavigationEstimate out = answer(frame, frame_verdict, new_keyframe);
  out.relocalized = is_relocalized;
  out.measured_rate_in_camera_rad_s = image_rate(features);
  if (new_keyframe) take_keyframe(frame);
  take_ground_keyframe();
  keep_reference();
  out.stage_ms = {0, flow_ms, watch.lap_ms(), 0};
  return out;
}

NavigationEstimate WindowNavigator::initialize(const Frame& frame, const FrameInterval& interval,
                                               const SensorReadings& readings) {
  first_stamp_ = previous_ = last_ = last_measured_ = imu_known_until_ = frame.stamp;
  window_.add_frame(frame.stamp, {}, {});
  (void)align_to_ground(frame, interval, readings);
  take_keyframe(frame);
  keep_reference();
  return answer(frame, Verdict::first_frame, true);
}

// While the ground plane is assumed.
std::optional<KeyframeView> WindowNavigator::align_to_ground(const Frame& frame,
                                                             const FrameInterval& interval,
                                                             const SensorReadings& readings) {
  has_flow_keyframe_ = false;
  const Window& window = window_.window();
  if (!window.start) return std::nullopt;
  FlowHints hints;
  if (const auto keyframe = window.find(window.ground_keyframe_id)) {
    const GroundView ground = GroundViews(window, false).at(*keyframe);
    hints.normal = -ground.normal.normalized();
  }
  has_flow_keyframe_ = flow_.step(frame, interval, readings, hints).new_keyframe;
  return flow_.view();
}

// The flow's keyframe, or a new one if the window does not have it. The first one once
// `can_align_to_ground`.
void WindowNavigator::take_ground_keyframe() {
  const Window& window = window_.window();
  const bool has_keyframe = window.find(window.ground_keyframe_id).has_value();
  if (has_keyframe ? !has_flow_keyframe_ : !window_.can_align_to_ground()) return;
  if (!has_flow_keyframe_) flow_.take_keyframe();
  window_.take_ground_keyframe();
}

// A new reference keyframe of the window is the latest one, or at rest an image like it.
void WindowNavigator::keep_reference() {
  if (window_.window().reference_id == reference_id_) return;
  reference_id_ = window_.window().reference_id;
  features_.keep_as_reference();
}

void WindowNavigator::take_keyframe(const Frame& frame) {
  const Window& window = window_.window();
  const KeyframeFeatures::Keyframe keyframe =
      features_.take_keyframe(frame, expected_features(window, window.reference_id));
  if (keyframe.features.empty()) return;
  previous_features_ = keyframe.features;
  window_.take_keyframe(keyframe.features, keyframe.realigned);
  world_from_keyframe_ = window_.state().world_from_imu.rotation * body_from_camera_.rotation;
}

// Velocity sigma: angular rate of the images times the depth of the scene. A standstill is detected
// some time after it began.
std::optional<CameraRest> WindowNavigator::rest(const Frame& frame,
                                                const FrameInterval& interval) const {
  if (!interval.standstill) return std::nullopt;
  return CameraRest{.since = {frame.stamp.ns - from_seconds(StandstillDetector::kMinRest_s).ns},
                    .velocity_sigma_m_s = interval.standstill->rate_rad_s *
                                          median_depth_m(window_.window()).value_or(rest_depth_m_)};
}

// Before the initialization velocity and scale are not observable.
Verdict WindowNavigator::verdict(const FrameInterval& interval) const {
  constexpr int kMinPoints = 12;
  constexpr double kMinInliers_ratio = 0.5;
  if (interval.rejection) return *interval.rejection;
  if (!window_.is_initialized()) {
    return window_.is_restarted() ? Verdict::lost : Verdict::ill_conditioned;
  }
  if (interval.standstill) return Verdict::still;
  const MeasuredPoints& points = window_.points();
  const bool is_explained =
      points.inliers >= kMinPoints && points.inliers >= kMinInliers_ratio * points.measured;
  return is_explained ? Verdict::ok : Verdict::too_few_inliers;
}

// Mean angular rate since the previous image, by the images.
std::optional<Eigen::Vector3d> WindowNavigator::image_rate(
    const std::vector<FeatureObservation>& features) {
  std::vector<BearingMatch> matches;
  auto before = previous_features_.begin();
  for (const FeatureObservation& feature : features) {
    while (before != previous_features_.end() && before->track_id < feature.track_id) ++before;
    if (before == previous_features_.end()) break;
    if (before->track_id != feature.track_id) continue;
    matches.push_back({before->bearing.homogeneous(), feature.bearing.homogeneous(),
                       0.25 * (before->covariance.trace() + feature.covariance.trace())});
  }
  previous_features_ = features;
  // of the two rotations that a plane allows, the gyroscope's
  Eigen::Quaterniond before_from_now = Eigen::Quaterniond::Identity();
  for (const ImuSample& sample : window_.samples_between(previous_, last_)) {
    const Eigen::Vector3d rate = sample.angular_rate_rad_s - window_.state().gyro_bias_rad_s;
    before_from_now = before_from_now * so3_exp(sample.dt_s * rate);
  }
  const Eigen::Quaterniond& imu_from_camera = body_from_camera_.rotation;
  const auto rotation =
      epipolar_rotation(matches, imu_from_camera.conjugate() * before_from_now * imu_from_camera);
  if (!rotation) return std::nullopt;
  return so3_log(*rotation) / seconds_between(previous_, last_);
}

std::vector<InertialFinding> WindowNavigator::inertial_findings() const {
  std::vector<InertialFinding> findings = stillkite::inertial_findings(window_);
  if (contradiction_) findings.push_back(*contradiction_);
  return findings;
}

NavigationEstimate WindowNavigator::answer(const Frame& frame, Verdict frame_verdict,
                                           bool new_keyframe) const {
  using Index = InertialIndex;
  const InertialState& state = window_.state();
  const RigidTransform& imu_from_camera = window_.extrinsics().imu_from_camera;
  const Eigen::Matrix3d R = state.world_from_imu.rotation.toRotationMatrix();
  // means over the interval, by the IMU
  double dt_s = 0;
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : window_.samples_between(previous_, frame.stamp)) {
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

  ScaleSource scale = ScaleSource::imu;
  if (window_.window().start && !window_.is_scale_measured()) scale = ScaleSource::initial_height;
  if (!window_.is_initialized()) scale = ScaleSource::none;

  EstimateParts parts{
      .verdict = frame_verdict,
      .source = EstimateSource::fused,
      .camera = {.pose = {window_.world_from_imu() * body_from_camera_,
                          pose_covariance(frame.stamp)},
                 .scale = scale,
                 .scale_stamp = scale == ScaleSource::imu ? frame.stamp : first_stamp_},
      .world_from_initial_camera = window_.world_from_first() * body_from_camera_,
      .twist_in_camera = {camera_from_world * velocity, camera_from_imu * rate},
      .velocity_in_world_m_s = velocity,
      .quality = {.flow_vectors = features_.found_count(),
                  .inlier_ratio = static_cast<double>(window_.points().inliers) /
                                  std::max(1, window_.points().measured),
                  .residual_px = focal_px_ * window_.points().residual},
      .new_keyframe = new_keyframe};
  const double density = window_.noise().gyro_density;
  Eigen::Matrix3d velocity_covariance =
      unmeasured_speed_m_s_ * unmeasured_speed_m_s_ * Eigen::Matrix3d::Identity();
  Eigen::Matrix3d rate_covariance =
      rate_sigma_rad_s_ * rate_sigma_rad_s_ * Eigen::Matrix3d::Identity();
  if (window_.is_initialized()) {
    const SlidingWindow::Matrix15d& P = window_.covariance();
    velocity_covariance = P.block<3, 3>(Index::kVelocity, Index::kVelocity);
    rate_covariance = P.block<3, 3>(Index::kGyroBias, Index::kGyroBias);
    if (dt_s > 0) rate_covariance.diagonal().array() += density * density / dt_s;
  }
  parts.twist_covariance.topLeftCorner<3, 3>() =
      camera_from_world * velocity_covariance * camera_from_world.transpose();
  parts.twist_covariance.bottomRightCorner<3, 3>() =
      camera_from_imu * rate_covariance * camera_from_imu.transpose();
  return make_estimate(frame, body_from_camera_, parts);
}

}  // namespace stillkite
