#include "navigation/paper_navigator.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/ego_motion/integration.hpp"
#include "estimation/ego_motion/motion_field.hpp"
#include "navigation/assumptions.hpp"
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
  track_.pose.covariance.diagonal() << kExact, kExact, kExact, tilt_variance, tilt_variance, kExact;
  track_.scale = initial.scale;
}

NavigationEstimate PaperNavigator::step(const Frame& frame, const FrameInterval& interval,
                                        const SensorReadings& readings) {
  StopWatch watch;
  // 1. The frame before and this one, I(t) and I(t+1).
  texture_.build(frame.grey, kTextureLevels);
  if (interval.spoiled == Verdict::first_frame) return start(frame, readings);
  const double pyramid_ms = watch.lap_ms();
  // 2. and 3. The flow LK(I(t+1), I(t)), and the six velocities that explain it best.
  const EgoMotion motion = measure(frame, interval, readings);
  (void)watch.lap_ms();
  // 4. Predict with a(t) and filter, an axis each.
  filter(motion, readings, interval.dt_s);
  // 5. Integrate position and angles.
  integrate(motion, readings, interval.dt_s);
  // 6. Other sensors' height and attitude, where there are any.
  correct(readings, frame.stamp);
  // 7. The next frame.
  previous_ = frame.grey;
  NavigationEstimate out = answer(frame, motion);
  out.stage_ms = {pyramid_ms, flow_ms_, solve_ms_, watch.lap_ms()};
  return out;
}

NavigationEstimate PaperNavigator::start(const Frame& frame, const SensorReadings& readings) {
  track_.scale_stamp = frame.stamp;
  correct(readings, frame.stamp);
  const double speed = kAnySpeed_heights_s * track_.pose.world_from_camera.translation.z();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i] = {0, i < 3 ? speed * speed : kAnyRate_rad_s * kAnyRate_rad_s};
  }
  before_ = world_from_start_ = track_.pose.world_from_camera;
  previous_ = frame.grey;
  return answer(frame, {.verdict = Verdict::first_frame});
}

EgoMotion PaperNavigator::measure(const Frame& frame, const FrameInterval& interval,
                                  const SensorReadings& readings) {
  StopWatch watch;
  flow_ms_ = solve_ms_ = 0;
  windows_.clear();
  if (interval.spoiled) return {.verdict = *interval.spoiled};
  if (is_bare(texture_.level(texture_.levels() - 1))) return {};
  windows_ = sampler_(flow_(previous_, frame.grey));
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
  motion_ = solver_.solve(windows_, ground_seen_from(track_.pose.world_from_camera), interval.dt_s,
                          prior);
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
  } else if (blind_s_ + dt_s > config_.trust.max_gap_s && blind_s_ <= config_.trust.max_gap_s) {
    forget_speed();
  }
  axes_ = filter_axes(config_.paper.filter, axes_, measured, acceleration, dt_s);
}

// What nothing has measured for too long is no speed any more.
void PaperNavigator::forget_speed() {
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
  after.translation.z() = std::max(after.translation.z(), kLowest * before_.translation.z());
  Matrix6d carried = track_.pose.covariance;

  // A measured step errs on its own; without measurement the error is one of speed and goes on.
  Matrix6d step = Matrix6d::Zero();
  if (motion.verdict == Verdict::ok) {
    Matrix6d J = Matrix6d::Zero();
    const Eigen::Matrix3d R = before_.rotation.toRotationMatrix();
    J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = dt_s * R;
    step = J * motion.covariance * J.transpose();
    carried = carried_covariance(track_.pose, after);
    blind_s_ = 0;
  } else {
    const double t2 = dt_s * (2 * blind_s_ + dt_s);  // of (t + dt)^2 - t^2
    for (int i = 0; i < 6; ++i) step(i, i) = t2 * axes_[static_cast<std::size_t>(i)].variance;
    const Eigen::Matrix3d R = before_.rotation.toRotationMatrix();
    step.bottomRightCorner<3, 3>() = R * step.bottomRightCorner<3, 3>() * R.transpose();
    blind_s_ += dt_s;
  }
  track_.pose = {after, carried + step};
}

void PaperNavigator::correct(const SensorReadings& readings, Timestamp now) {
  const ScaledPose before = track_;
  const Eigen::Quaterniond& attitude = before.pose.world_from_camera.rotation;
  track_ =
      with_readings(before, of_camera(readings, body_from_camera_, attitude), config_.sensors, now);
  if (before.scale == ScaleSource::none && track_.scale != ScaleSource::none) {
    // start and speed were in heights too
    const double factor = track_.pose.world_from_camera.translation.z() /
                          before.pose.world_from_camera.translation.z();
    world_from_start_.translation *= factor;
    for (std::size_t i = 0; i < 3; ++i) {
      axes_[i] = {factor * axes_[i].value, factor * factor * axes_[i].variance};
    }
  }
}

Twist PaperNavigator::twist_half_way() const {
  const Vector6d v = velocities();
  const RigidTransform half_way = interpolate(before_, track_.pose.world_from_camera, 0.5);
  return {half_way.rotation.conjugate() * v.head<3>(), v.tail<3>()};
}

NavigationEstimate PaperNavigator::answer(const Frame& frame, const EgoMotion& motion) const {
  const RigidTransform& world_from_camera = track_.pose.world_from_camera;
  NavigationEstimate out;
  out.stamp = frame.stamp;
  out.frame_index = frame.index;
  out.verdict = motion.verdict;
  out.world_from_body = world_from_camera * body_from_camera_.inverse();
  out.world_from_start = world_from_start_ * body_from_camera_.inverse();
  out.pose_covariance = track_.pose.covariance;
  out.twist_in_camera = twist_half_way();
  Vector6d variance;
  for (int i = 0; i < 6; ++i) variance(i) = axes_[static_cast<std::size_t>(i)].variance;
  Matrix6d J = Matrix6d::Identity();
  J.topLeftCorner<3, 3>() = world_from_camera.rotation.conjugate().toRotationMatrix();
  out.twist_covariance = J * variance.asDiagonal() * J.transpose();
  if (motion.verdict == Verdict::ok) out.measured_twist = motion.twist;
  out.velocity_in_world_m_s = velocities().head<3>();
  out.scale = track_.scale;
  if (out.scale != ScaleSource::none) {
    out.scale_age_s = seconds_between(track_.scale_stamp, frame.stamp);
  }
  double flow_px = 0;
  for (const FlowWindow& window : windows_) flow_px += static_cast<double>(window.flow_px.norm());
  out.quality = {
      .windows = motion.windows,
      .inlier_ratio = motion.inlier_ratio,
      .mean_flow_px = windows_.empty() ? 0 : flow_px / static_cast<double>(windows_.size()),
      .residual_px = motion.residual_px,
      .condition = std::isfinite(motion.condition) ? motion.condition : 0};
  if (motion.verdict == Verdict::ok) out.image_speed_px_s = out.quality.mean_flow_px / dt_s_;
  return out;
}

std::vector<WindowFlow> PaperNavigator::windows() const {
  std::vector<WindowFlow> out;
  const GroundPlane ground = ground_seen_from(before_);
  const double inlier_px = config_.paper.least_squares.inlier_px;
  for (const FlowWindow& window : windows_) {
    if (!(window.information_xx + window.information_yy > 0)) continue;
    const auto bearing = undistort(camera_, window.pixel.cast<double>());
    if (!bearing) continue;
    const Eigen::Vector2d explained_px =
        motion_field_px(camera_, ground, *bearing) * motion_.twist.vector() * dt_s_;
    const bool inlier = (window.flow_px.cast<double>() - explained_px).norm() <= inlier_px;
    out.push_back({window.pixel + window.flow_px, window.flow_px, inlier ? 1.0F : 0.0F});
  }
  return out;
}

}  // namespace stillkite
