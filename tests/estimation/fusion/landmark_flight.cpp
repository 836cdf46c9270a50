#include "tests/estimation/fusion/landmark_flight.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "estimation/ego_motion/integration.hpp"
#include "geometry/angle.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/flight/flight.hpp"

namespace stillkite {
namespace {

constexpr double kPatrolFrame_s = 1.0 / 25;
// the flow paper's camera, section 5.1
constexpr double kPatrolFocal_px = 1152.77;
constexpr double kHalfWidth = 960 / kPatrolFocal_px;
constexpr double kHalfHeight = 540 / kPatrolFocal_px;

// Of (velocity, rate) of a camera that looks down: a shift by dv_x is a turn by -h w_y, one by dv_y
// a turn by h w_x. Along and about the optical axis nothing is confused.
Matrix6d flow_covariance(const PatrolScene& scene) {
  const double along = std::sqrt(1 - square(scene.confusion));
  Vector6d sigma;
  sigma << scene.velocity_noise_m_s * Eigen::Vector3d(1, 1, along),
      scene.rate_noise_rad_s * Eigen::Vector3d(1, 1, along);
  Matrix6d C = sigma.cwiseAbs2().asDiagonal();
  C(0, 4) = C(4, 0) = -scene.confusion * sigma[0] * sigma[4];
  C(1, 3) = C(3, 1) = scene.confusion * sigma[1] * sigma[3];
  return C;
}

// integrate_twist's inverse.
Twist twist_between(const RigidTransform& a, const RigidTransform& b, double dt_s) {
  const RigidTransform step = a.inverse() * b;
  const Eigen::Vector3d turn = so3_log(step.rotation);
  const Eigen::Matrix3d J = so3_left_jacobian(turn);
  return {J.partialPivLu().solve(step.translation) / dt_s, turn / dt_s};
}

LandmarkFilterConfig patrol_filter(const PatrolScene& scene) {
  return {.velocity_bias_sigma_m_s = scene.velocity_bias_m_s,
          .rate_bias_sigma_rad_s = scene.rate_bias_rad_s,
          .bias_correlation_s = scene.bias_correlation_s};
}

}  // namespace

LandmarkFlight::LandmarkFlight(const PatrolScene& scene, std::uint64_t seed)
    : scene_(scene),
      random_(seed, 77),
      trajectory_(make_trajectory({.shape = FlightShape::turn,
                                   .duration_s = scene.seconds,
                                   .height_m = scene.height_m,
                                   .speed_m_s = scene.speed_m_s,
                                   .turn_rate_deg_s = scene.turn_rate_deg_s,
                                   .tilt_sway_deg = scene.tilt_sway_deg},
                                  seed)),
      flow_covariance_(flow_covariance(scene)),
      flow_root_(flow_covariance_.llt().matrixL()),
      truth_(truth_at(0)),
      filter_(patrol_filter(scene), make_map(), believed_start(), start_covariance()),
      dead_reckoned_(truth_) {
  bias_sigma_ << Eigen::Vector3d::Constant(scene.velocity_bias_m_s),
      Eigen::Vector3d::Constant(scene.rate_bias_rad_s);
  for (int i = 0; i < 6; ++i) bias_[i] = bias_sigma_[i] * random_.normal();
}

RigidTransform LandmarkFlight::truth_at(double t_s) const {
  return trajectory_.at(t_s).world_from_body * camera_raised_forward(0);
}

Eigen::Vector3d LandmarkFlight::normal3() {
  const double x = random_.normal(), y = random_.normal(), z = random_.normal();
  return {x, y, z};
}

// All over the round and what the camera sees beside it.
std::vector<KnownLandmark> LandmarkFlight::make_map() {
  const double radius_m = scene_.speed_m_s / (scene_.turn_rate_deg_s * kDegree);
  const double beside_m = kHalfWidth * scene_.height_m;
  const double inner_m = std::max(0.0, radius_m - beside_m);
  const double outer_m = radius_m + beside_m;
  const double area_km2 = 1e-6 * std::numbers::pi * (square(outer_m) - square(inner_m));
  const auto count = static_cast<std::size_t>(std::lround(area_km2 * scene_.landmarks_per_km2));
  const Eigen::Vector3d middle(0, radius_m, 0);
  std::vector<KnownLandmark> map;
  map.reserve(count);
  places_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double r = std::sqrt(random_.uniform(square(inner_m), square(outer_m)));
    const double angle = random_.uniform(0, 2 * std::numbers::pi);
    places_.emplace_back(middle + Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle),
                                                  scene_.relief_m * random_.normal()));
    map.push_back({places_.back() + scene_.landmark_sigma_m * normal3(),
                   square(scene_.landmark_sigma_m) * Eigen::Matrix3d::Identity()});
  }
  return map;
}

Matrix6d LandmarkFlight::start_covariance() const {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(square(scene_.start_position_sigma_m)),
      Eigen::Vector3d::Constant(square(scene_.start_rotation_sigma_rad));
  return variance.asDiagonal();
}

RigidTransform LandmarkFlight::believed_start() {
  const RigidTransform start = truth_at(0);
  const Eigen::Vector3d turn = scene_.start_rotation_sigma_rad * normal3();
  return {so3_exp(turn) * start.rotation,
          start.translation + scene_.start_position_sigma_m * normal3()};
}

void LandmarkFlight::step() {
  ++frame_;
  time_s_ = frame_ * kPatrolFrame_s;
  const RigidTransform before = truth_;
  truth_ = truth_at(time_s_);
  const double fade = std::exp(-kPatrolFrame_s / scene_.bias_correlation_s);
  Vector6d white;
  for (int i = 0; i < 6; ++i) white[i] = random_.normal();
  const Twist seen = Twist::from_vector(twist_between(before, truth_, kPatrolFrame_s).vector() +
                                        bias_ + flow_root_ * white);
  for (int i = 0; i < 6; ++i) {
    bias_[i] = fade * bias_[i] + std::sqrt(1 - fade * fade) * bias_sigma_[i] * random_.normal();
  }
  filter_.predict(seen, flow_covariance_, kPatrolFrame_s);
  dead_reckoned_ = integrate_twist(dead_reckoned_, seen, kPatrolFrame_s);
  if (frame_ % scene_.frames_per_sighting == 0) update_from_landmarks();
}

void LandmarkFlight::update_from_landmarks() {
  const RigidTransform camera_from_world = truth_.inverse();
  const double sigma = scene_.pixel_sigma_px / kPatrolFocal_px;
  std::vector<LandmarkSighting> seen;
  std::vector<bool> is_false;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Eigen::Vector3d in_camera = camera_from_world * places_[i];
    const Eigen::Vector2d bearing = in_camera.hnormalized();
    if (std::abs(bearing.x()) > kHalfWidth || std::abs(bearing.y()) > kHalfHeight) continue;
    const double x = random_.normal(), y = random_.normal();
    seen.push_back({.landmark = static_cast<int>(i),
                    .bearing = bearing + sigma * Eigen::Vector2d(x, y),
                    .covariance = square(sigma) * Eigen::Matrix2d::Identity()});
  }
  for (LandmarkSighting& one : seen) {
    is_false.push_back(random_.uniform() < scene_.false_ratio);
    if (!is_false.back()) continue;
    if (random_.uniform() < 0.5) {
      const auto other = static_cast<std::size_t>(random_.uniform(0, double(seen.size())));
      is_false.back() = seen[other].landmark != one.landmark;
      one.landmark = seen[other].landmark;
    } else {
      const double r = scene_.false_within_px / kPatrolFocal_px * std::sqrt(random_.uniform());
      const double angle = random_.uniform(0, 2 * std::numbers::pi);
      one.bearing += r * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
  }
  const std::vector<SightingVerdict> verdicts = filter_.update(seen);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const bool is_used = verdicts[i] == SightingVerdict::used;
    ++sightings_.all;
    sightings_.used += is_used ? 1 : 0;
    sightings_.falsehoods += is_false[i] ? 1 : 0;
    sightings_.used_falsehoods += is_used && is_false[i] ? 1 : 0;
  }
}

Vector6d LandmarkFlight::error_of(const RigidTransform& estimate) const {
  Vector6d error;
  error << truth_.translation - estimate.translation,
      so3_log(truth_.rotation * estimate.rotation.conjugate());
  return error;
}

double LandmarkFlight::nees() const {
  const Vector6d error = error_of(filter_.world_from_camera());
  const Matrix6d P = filter_.pose_covariance();
  return error.dot(P.llt().solve(error));
}

}  // namespace stillkite
