#include "tests/estimation/fusion/fusion_scene.hpp"

#include "geometry/plane.hpp"

namespace stillkite {
namespace {

constexpr double kFrame_s = 1.0 / 30;
constexpr int kInertialSteps = 7;

// Along the world's x: image right is -y of the world, image down is -z.
RigidTransform looking_ahead() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {Eigen::Quaterniond(R), {0, 0, 3}};
}

Eigen::Vector3d gravity() {
  return {0, 0, -9.80665};
}

FusionStart start_of(const FusionScene& scene, std::uint64_t seed) {
  FusionStart start{.world_from_camera = looking_ahead(),
                    .velocity_sigma = scene.velocity_sigma_m_s,
                    .log_unit_sigma = scene.log_unit_sigma};
  if (scene.lean_sigma_rad == 0) return start;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> lean_rad(0, scene.lean_sigma_rad);
  const Eigen::Vector3d lean(lean_rad(engine), lean_rad(engine), 0);
  start.world_from_camera.rotation = so3_exp(lean) * start.world_from_camera.rotation;
  start.tilt_sigma_rad = scene.lean_sigma_rad;
  return start;
}

}  // namespace

FusionSimulation::FusionSimulation(const FusionScene& scene, const FusionConfig& config,
                                   std::uint64_t seed)
    : scene_(scene),
      config_(config),
      engine_(seed * 7919 + 17),
      filter_(config, start_of(scene, seed)) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 3; ++i) {
    sway_phase_[i] = 3 * uniform(engine_);
    turn_phase_[i] = 3 * uniform(engine_);
  }
  gyro_bias_ = config.gyro_bias_sigma_rad_s * normal3();
  accel_bias_ = config.accel_bias_sigma_m_s2 * normal3();
  height_error_log_ = config.height_sigma_ratio * normal();
  filter_.take_anchor();
  for (int i = 0; i < config.landmarks; ++i) points_.push_back(add_point(i, scene.scale_error_log));
  for (int i = 0; i < scene.offered; ++i) points_.push_back(offer_point(config.landmarks + i));
  windows_.resize(points_.size());
  first_bearing_ = (truth_at(0).world_from_camera.inverse() * points_[0]).hnormalized();
}

Eigen::Vector2d FusionSimulation::random_bearing() {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Eigen::Vector2d(0.8 * uniform(engine_), 0.5 * uniform(engine_));
}

FeatureView FusionSimulation::reference_of(int feature, const Eigen::Vector2d& bearing) {
  const double noise = scene_.pixel_sigma_px / scene_.focal_px;
  return {feature, bearing + noise * Eigen::Vector2d(normal(), normal()),
          noise * noise * Eigen::Matrix2d::Identity()};
}

// As far as is guessed of what lies ahead.
Eigen::Vector3d FusionSimulation::offer_point(int feature) {
  const Eigen::Vector2d bearing = random_bearing();
  filter_.offer_landmark(reference_of(feature, bearing));
  const double guess = filter_.landmarks().front().inverse_depth;
  return truth().world_from_camera * (bearing.homogeneous() / guess);
}

Eigen::Vector3d FusionSimulation::add_point(int feature, double error_log) {
  const Eigen::Vector2d bearing = random_bearing();
  filter_.add_landmark(reference_of(feature, bearing));
  const double guess = filter_.landmarks().back().inverse_depth;
  const double inverse_depth =
      std::max(0.1, 1 + scene_.inverse_depth_spread * normal()) * guess * std::exp(-error_log);
  return truth().world_from_camera * (bearing.homogeneous() / inverse_depth);
}

FusionTruth FusionSimulation::truth_at(double t_s) const {
  // (1 - cos) begins at rest, and at its start
  FusionTruth truth;
  const RigidTransform start = looking_ahead();
  Eigen::Vector3d turn;
  Eigen::Vector3d way;
  for (int i = 0; i < 3; ++i) {
    const double w = 1.1 + 0.25 * i;
    const double amplitude = scene_.sway_m * std::cos(sway_phase_[i]);
    way[i] = amplitude * (1 - std::cos(w * t_s));
    truth.velocity_in_world_m_s[i] = amplitude * w * std::sin(w * t_s);
    truth.acceleration_in_world_m_s2[i] = amplitude * w * w * std::cos(w * t_s);
    turn[i] = scene_.turn_rad * std::sin((0.9 + 0.2 * i) * t_s) * std::cos(turn_phase_[i]);
  }
  way.y() += 0.5 * scene_.drift_m_s2 * t_s * t_s;
  truth.velocity_in_world_m_s.y() += scene_.drift_m_s2 * t_s;
  truth.acceleration_in_world_m_s2.y() += scene_.drift_m_s2;
  truth.world_from_camera = {so3_exp(turn) * start.rotation, start.translation + way};
  return truth;
}

void FusionSimulation::step() {
  const double dt_s = kFrame_s / kInertialSteps;
  filter_.begin_step();
  for (int i = 0; i < kInertialSteps; ++i) {
    const FusionTruth a = truth_at(time_s_);
    const FusionTruth mid = truth_at(time_s_ + 0.5 * dt_s);
    const FusionTruth b = truth_at(time_s_ + dt_s);
    time_s_ += dt_s;
    InertialStep step{
        .dt_s = dt_s, .angular_rate_rad_s = {}, .is_gyro = true, .specific_force_m_s2 = {}};
    const double root_rate = 1 / std::sqrt(dt_s);
    const Eigen::Vector3d rate =
        so3_log(a.world_from_camera.rotation.conjugate() * b.world_from_camera.rotation) / dt_s;
    if (scene_.has_imu) {
      step.angular_rate_rad_s = rate + gyro_bias_ + config_.gyro_density * root_rate * normal3();
      step.specific_force_m_s2 =
          a.world_from_camera.rotation.conjugate() * (mid.acceleration_in_world_m_s2 - gravity()) +
          accel_bias_ + config_.accel_density * root_rate * normal3();
    } else {
      step.is_gyro = false;
      step.angular_rate_rad_s = rate + 0.5 * root_rate * normal3();
    }
    filter_.predict(step);
  }
  if (scene_.has_flow) update_from_plane();
  if (!scene_.has_landmarks) return;
  filter_.update_landmarks(landmark_views());
  if (scene_.renew_every_s > 0 && time_s_ - anchor_s_ >= scene_.renew_every_s) renew_anchor();
}

// With noise of their own: where a feature is in the reference is seen once.
void FusionSimulation::renew_anchor() {
  constexpr double kSamePoint_px = 3;
  anchor_s_ = time_s_;
  windows_.assign(points_.size(), {});
  filter_.take_anchor();
  std::vector<FeatureView> features = landmark_views();
  features.erase(features.begin(), features.begin() + scene_.renewed);
  filter_.number_landmarks(features, kSamePoint_px / scene_.focal_px);
  for (int i = 0; i < scene_.renewed; ++i) {
    points_[static_cast<std::size_t>(i)] = add_point(i, scene_.renewed_error_log);
  }
}

std::vector<FeatureView> FusionSimulation::landmark_views() {
  const RigidTransform camera_from_world = truth().world_from_camera.inverse();
  std::vector<FeatureView> seen;
  const double sigma = scene_.pixel_sigma_px / scene_.focal_px;
  const double noise = scene_.true_noise_ratio * sigma;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Eigen::Vector2d bearing = (camera_from_world * points_[i]).hnormalized();
    if (i == 0 && scene_.first_moves_backwards) bearing = 2 * first_bearing_ - bearing;
    if (i < shifted_) bearing.x() += (i % 2 == 0 ? 1 : -1) * shift_px_ / scene_.focal_px;
    bearing += stray_error_px(i) / scene_.focal_px;
    if (scene_.window_error_ratio > 0) bearing += window_error_px(i) / scene_.focal_px;
    seen.push_back({static_cast<int>(i), bearing + noise * Eigen::Vector2d(normal(), normal()),
                    sigma * sigma * Eigen::Matrix2d::Identity()});
  }
  return seen;
}

Eigen::Vector3d FusionSimulation::way_in_depths(std::size_t i) const {
  const RigidTransform anchor = truth_at(anchor_s_).world_from_camera;
  return (truth().world_from_camera.translation - anchor.translation) /
         (anchor.inverse() * points_[i]).z();
}

Eigen::Vector2d FusionSimulation::stray_error_px(std::size_t i) const {
  constexpr double kGoldenAngle_rad = 2.4;
  if (i >= static_cast<std::size_t>(scene_.strays)) return Eigen::Vector2d::Zero();
  const double to = kGoldenAngle_rad * static_cast<double>(i);
  return 10 * way_in_depths(i).norm() * scene_.stray_px *
         Eigen::Vector2d(std::cos(to), std::sin(to));
}

// Beside the white noise: what lasts, and what is new but grows with it.
Eigen::Vector2d FusionSimulation::window_error_px(std::size_t i) {
  const Eigen::Vector3d way = way_in_depths(i);
  Window& window = windows_[i];
  const double away = std::min(way.norm(), window.way.norm());
  const double kept = std::exp(-(way - window.way).norm() / (scene_.window_error_way + 4 * away));
  window.way = way;
  const double grown = way.norm() / scene_.window_error_way;
  const double lasting = scene_.window_error_ratio * scene_.pixel_sigma_px *
                         std::sqrt((1 - kept * kept) * (1 + grown));
  window.error_px = kept * window.error_px + lasting * Eigen::Vector2d(normal(), normal());
  return window.error_px +
         scene_.pixel_sigma_px * std::sqrt(grown) * Eigen::Vector2d(normal(), normal());
}

// As from a keyframe that is replaced now and then, its height off by what the start's is.
void FusionSimulation::update_from_plane() {
  const double start_height_m = looking_ahead().translation.z();
  const double height_m = truth_at(keyframe_s_).world_from_camera.translation.z();
  const RigidTransform camera_from_keyframe =
      truth().world_from_camera.inverse() * truth_at(keyframe_s_).world_from_camera;
  const double true_height_m = height_m + start_height_m * std::expm1(-height_error_log_);
  const double sigma = 1e-3;
  const PlaneMotion seen{
      .rotation = so3_exp(sigma * normal3()) * camera_from_keyframe.rotation,
      .translation = camera_from_keyframe.translation / true_height_m + sigma * normal3(),
      .normal = ground_plane_in_camera(truth_at(keyframe_s_).world_from_camera).normal_in_camera};
  filter_.update_keyframe_view(view_of(seen, sigma), 1);
  constexpr double kPeriod_s = 0.7;
  if (time_s_ - keyframe_s_ < kPeriod_s) return;
  filter_.take_keyframe();
  keyframe_s_ = time_s_;
}

Vector6d FusionSimulation::pose_error() const {
  return error_of(filter_.world_from_camera_m());
}

Vector6d FusionSimulation::upright_pose_error() const {
  return error_of(filter_.aligned_from_world() * filter_.world_from_camera_m());
}

Vector6d FusionSimulation::error_of(const RigidTransform& estimate) const {
  const RigidTransform true_pose = truth().world_from_camera;
  Vector6d error;
  error << true_pose.translation - estimate.translation,
      so3_log(true_pose.rotation * estimate.rotation.conjugate());
  return error;
}

}  // namespace stillkite
