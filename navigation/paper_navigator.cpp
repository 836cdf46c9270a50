#include "navigation/paper_navigator.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/ego_motion/integration.hpp"
#include "estimation/ego_motion/motion_field.hpp"
#include "navigation/assumptions.hpp"
#include "navigation/estimate_parts.hpp"
#include "navigation/image_texture.hpp"
#include "navigation/stop_watch.hpp"

namespace stillkite {
namespace {

constexpr int kTextureLevels = 3;

}  // namespace

PaperNavigator::PaperNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                               const NavigatorConfig& config, const InitialState& initial)
    : camera_(camera),
      body_from_camera_(body_from_camera),
      config_(config),
      flow_(config.paper.flow),
      sampler_(config.paper.flow.stride_px),
      solver_(camera, config.paper.least_squares) {
  const double tilt_variance = config.initial_tilt_sigma_rad * config.initial_tilt_sigma_rad;
  track_.pose.world_from_camera = initial.world_from_body * body_from_camera;
  track_.pose.covariance.diagonal() << kExactVariance, kExactVariance, kExactVariance,
      tilt_variance, tilt_variance, kExactVariance;
  track_.scale = initial.scale;
}

NavigationEstimate PaperNavigator::step(const Frame& frame, const FrameInterval& interval,
                                        const SensorReadings& readings) {
  StopWatch watch;
  // 1. Frames I(t) and I(t+1).
  texture_.build(frame.grey, kTextureLevels);
  if (interval.rejection == Verdict::first_frame) return initialize(frame, readings);
  const double pyramid_ms = watch.lap_ms();
  // 2. and 3. Flow LK(I(t+1), I(t)); least squares for six velocities.
  const EgoMotion motion = measure(frame, interval, readings);
  (void)watch.lap_ms();
  // 4. Predict with a(t) and filter each axis.
  filter(motion, readings, interval.dt_s);
  // 5. Integrate position and angles.
  integrate(motion, readings, interval.dt_s);
  // 6. Update by height and attitude readings.
  correct(readings, frame.stamp);
  // 7. Continue with the next frame.
  previous_ = frame.grey;
  NavigationEstimate out = answer(frame, motion);
  out.stage_ms = {pyramid_ms, flow_ms_, solve_ms_, watch.lap_ms()};
  return out;
}

NavigationEstimate PaperNavigator::initialize(const Frame& frame, const SensorReadings& readings) {
  track_.scale_stamp = frame.stamp;
  correct(readings, frame.stamp);
  const double speed = kInitialSpeedSigma_heights_s * track_.pose.world_from_camera.translation.z();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i] = {0, i < 3 ? speed * speed : kInitialRateSigma_rad_s * kInitialRateSigma_rad_s};
  }
  before_ = world_from_initial_ = track_.pose.world_from_camera;
  previous_ = frame.grey;
  return answer(frame, {.verdict = Verdict::first_frame});
}

EgoMotion PaperNavigator::measure(const Frame& frame, const FrameInterval& interval,
                                  const SensorReadings& readings) {
  StopWatch watch;
  flow_ms_ = solve_ms_ = 0;
  vectors_.clear();
  if (interval.rejection) return {.verdict = *interval.rejection};
  if (is_textureless(texture_.level(texture_.levels() - 1))) return {};
  vectors_ = sampler_(flow_(previous_, frame.grey));
  flow_ms_ = watch.lap_ms();
  std::optional<TwistPrior> prior;
  if (readings.mean_angular_rate_in_body_rad_s) {
    const Eigen::Vector3d rate =
        body_from_camera_.rotation.conjugate() * *readings.mean_angular_rate_in_body_rad_s;
    const double sigma = config_.sensors.gyro_sigma_rad_s;
    prior = TwistPrior{};
    prior->mean.angular_rate_rad_s = rate;
    prior->information.diagonal().tail<3>().setConstant(1 / (sigma * sigma));
  }
  motion_ = solver_.solve(vectors_, ground_plane_in_camera(track_.pose.world_from_camera),
                          interval.dt_s, prior);
  const Vector6d by_interval = frame.stamp_sigma_s / interval.dt_s * motion_.twist.vector();
  motion_.covariance += 2 * by_interval * by_interval.transpose();
  dt_s_ = interval.dt_s;
  solve_ms_ = watch.lap_ms();
  return motion_;
}

Vector6d PaperNavigator::velocities() const {
  Vector6d v;
  for (int i = 0; i < 6; ++i) v(i) = axes_[static_cast<std::size_t>(i)].value;
  return v;
}

void PaperNavigator::filter(const EgoMotion& motion, const SensorReadings& readings, double dt_s) {
  const Eigen::Quaterniond& attitude = track_.pose.world_from_camera.rotation;
  Vector6d acceleration = readings.acceleration.value_or(Vector6d::Zero());
  acceleration.tail<3>() = body_from_camera_.rotation.conjugate() * acceleration.tail<3>();
  std::optional<AxisMeasurement> measured;
  if (motion.verdict == Verdict::ok) {
    measured = in_filter_axes(motion.twist, motion.covariance, attitude);
  } else if (unmeasured_s_ + dt_s > config_.trust.max_gap_s &&
             unmeasured_s_ <= config_.trust.max_gap_s) {
    reset_twist();
  }
  axes_ = filter_axes(config_.paper.filter, axes_, measured, acceleration, dt_s);
}

// Zero velocity with the former one in its standard deviation.
void PaperNavigator::reset_twist() {
  for (AxisEstimate& axis : axes_) {
    const double sigma = std::abs(axis.value) + std::sqrt(axis.variance);
    axis = {0, sigma * sigma};
  }
}

void PaperNavigator::integrate(const EgoMotion& motion, const SensorReadings& readings,
                               double dt_s) {
  const Vector6d v = velocities();
  const Vector6d acceleration = readings.acceleration.value_or(Vector6d::Zero());
  before_ = track_.pose.world_from_camera;
  RigidTransform after;
  if (config_.paper.integration == Integration::euler) {
    // the paper's angles are the body's, its velocity the camera's
    const Eigen::Quaterniond& mount = body_from_camera_.rotation;
    after = integrate_euler({before_.rotation * mount.conjugate(), before_.translation},
                            v.head<3>(), mount * v.tail<3>(), acceleration, dt_s);
    after.rotation = (after.rotation * mount).normalized();
  } else {
    after =
        integrate_twist(before_, {before_.rotation.conjugate() * v.head<3>(), v.tail<3>()}, dt_s);
  }
  after.translation.z() =
      std::max(after.translation.z(), kMinHeightRatio * before_.translation.z());
  Matrix6d propagated = track_.pose.covariance;

  // Measured steps have independent errors; unmeasured ones share the velocity error.
  Matrix6d step = Matrix6d::Zero();
  if (motion.verdict == Verdict::ok) {
    Matrix6d J = Matrix6d::Zero();
    const Eigen::Matrix3d R = before_.rotation.toRotationMatrix();
    J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = dt_s * R;
    step = J * motion.covariance * J.transpose();
    propagated = propagated_covariance(track_.pose, after);
    unmeasured_s_ = 0;
  } else {
    const double t2 = dt_s * (2 * unmeasured_s_ + dt_s);  // (t + dt)^2 - t^2
    for (int i = 0; i < 6; ++i) step(i, i) = t2 * axes_[static_cast<std::size_t>(i)].variance;
    const Eigen::Matrix3d R = before_.rotation.toRotationMatrix();
    step.bottomRightCorner<3, 3>() = R * step.bottomRightCorner<3, 3>() * R.transpose();
    unmeasured_s_ += dt_s;
  }
  track_.pose = {after, propagated + step};
}

void PaperNavigator::correct(const SensorReadings& readings, Timestamp now) {
  const ScaledPose before = track_;
  const Eigen::Quaterniond& attitude = before.pose.world_from_camera.rotation;
  track_ = apply_readings(before, camera_readings(readings, body_from_camera_, attitude),
                          config_.sensors, now);
  if (before.scale == ScaleSource::none && track_.scale != ScaleSource::none) {
    // initial pose and velocity were in heights, too
    const double factor = track_.pose.world_from_camera.translation.z() /
                          before.pose.world_from_camera.translation.z();
    world_from_initial_.translation *= factor;
    for (std::size_t i = 0; i < 3; ++i) {
      axes_[i] = {factor * axes_[i].value, factor * factor * axes_[i].variance};
    }
  }
}

Twist PaperNavigator::mid_interval_twist() const {
  const Vector6d v = velocities();
  const RigidTransform midpoint = interpolate(before_, track_.pose.world_from_camera, 0.5);
  return {midpoint.rotation.conjugate() * v.head<3>(), v.tail<3>()};
}

NavigationEstimate PaperNavigator::answer(const Frame& frame, const EgoMotion& motion) const {
  Vector6d variance;
  for (int i = 0; i < 6; ++i) variance(i) = axes_[static_cast<std::size_t>(i)].variance;
  Matrix6d J = Matrix6d::Identity();
  J.topLeftCorner<3, 3>() = track_.pose.world_from_camera.rotation.conjugate().toRotationMatrix();
  EstimateParts parts{.verdict = motion.verdict,
                      .camera = track_,
                      .world_from_initial_camera = world_from_initial_,
                      .twist_in_camera = mid_interval_twist(),
                      .velocity_in_world_m_s = velocities().head<3>()};
  parts.twist_covariance = J * variance.asDiagonal() * J.transpose();
  double flow_px = 0;
  for (const FlowVector& vector : vectors_) flow_px += static_cast<double>(vector.flow_px.norm());
  parts.quality = {
      .flow_vectors = motion.vectors,
      .inlier_ratio = motion.inlier_ratio,
      .mean_flow_px = vectors_.empty() ? 0 : flow_px / static_cast<double>(vectors_.size()),
      .residual_px = motion.residual_px,
      .condition = std::isfinite(motion.condition) ? motion.condition : 0};
  NavigationEstimate out = make_estimate(frame, body_from_camera_, parts);
  if (motion.verdict == Verdict::ok) {
    out.measured_twist = motion.twist;
    out.measured_rate_in_camera_rad_s = motion.twist.angular_rate_rad_s;
  }
  return out;
}

std::vector<WeightedFlow> PaperNavigator::flow_vectors() const {
  std::vector<WeightedFlow> out;
  const GroundPlane ground = ground_plane_in_camera(before_);
  const double inlier_px = config_.paper.least_squares.inlier_px;
  for (const FlowVector& vector : vectors_) {
    if (!(vector.information_xx + vector.information_yy > 0)) continue;
    const auto bearing = undistort(camera_, vector.pixel.cast<double>());
    if (!bearing) continue;
    const Eigen::Vector2d explained_px =
        motion_field_px(camera_, ground, *bearing) * motion_.twist.vector() * dt_s_;
    const bool inlier = (vector.flow_px.cast<double>() - explained_px).norm() <= inlier_px;
    out.push_back({vector.pixel + vector.flow_px, vector.flow_px, inlier ? 1.0F : 0.0F});
  }
  return out;
}

}  // namespace stillkite
