#include "hand_held_motion.hpp"

#include <cmath>

namespace stillkite {
namespace {

Eigen::Vector3d position(const HandHeldMotion& motion, double t) {
  return motion.amplitude_m * Eigen::Vector3d(std::sin(1.3 * t) + 0.4 * std::cos(2.9 * t),
                                              0.8 * std::cos(1.7 * t + 1),
                                              0.6 * std::sin(2.1 * t + 0.5));
}

Eigen::Quaterniond attitude(const HandHeldMotion& motion, double t) {
  const double a = motion.tilt_rad;
  return so3_exp({0, 0, 0.4 * t * a}) * so3_exp({a * std::sin(1.1 * t), a * std::cos(1.9 * t), 0});
}

}  // namespace

InertialState HandHeldMotion::state(double t_s) const {
  constexpr double kStep_s = 1e-4;
  return {.world_from_imu = {attitude(*this, t_s), position(*this, t_s)},
          .velocity_in_world_m_s =
              (position(*this, t_s + kStep_s) - position(*this, t_s - kStep_s)) / (2 * kStep_s),
          .gyro_bias_rad_s = gyro_bias_rad_s,
          .accel_bias_m_s2 = accel_bias_m_s2};
}

Eigen::Vector3d HandHeldMotion::angular_rate(double t_s) const {
  constexpr double kStep_s = 1e-4;
  return so3_log(attitude(*this, t_s - kStep_s).conjugate() * attitude(*this, t_s + kStep_s)) /
         (2 * kStep_s);
}

Eigen::Vector3d HandHeldMotion::specific_force(double t_s) const {
  constexpr double kStep_s = 1e-3;
  const Eigen::Vector3d acceleration =
      (position(*this, t_s + kStep_s) - 2 * position(*this, t_s) + position(*this, t_s - kStep_s)) /
      (kStep_s * kStep_s);
  return attitude(*this, t_s).conjugate() * (acceleration - gravity_in_world());
}

std::vector<ImuSample> HandHeldMotion::samples(double from_s, double to_s, const ImuNoise& noise,
                                               std::mt19937& random) const {
  constexpr double kRate_hz = 200;
  std::normal_distribution<double> normal;
  const auto white = [&](double density, double dt_s) -> Eigen::Vector3d {
    return density / std::sqrt(dt_s) *
           Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  const int count = static_cast<int>(std::lround((to_s - from_s) * kRate_hz));
  std::vector<ImuSample> samples;
  for (int i = 0; i < count; ++i) {
    const double dt_s = (to_s - from_s) / count;
    const double middle_s = from_s + (i + 0.5) * dt_s;
    samples.push_back({.dt_s = dt_s,
                       .angular_rate_rad_s = angular_rate(middle_s) + gyro_bias_rad_s +
                                             white(noise.gyro_density, dt_s),
                       .specific_force_m_s2 = specific_force(middle_s) + accel_bias_m_s2 +
                                              white(noise.accel_density, dt_s)});
  }
  return samples;
}

std::vector<ImuInterval> HandHeldMotion::readings(double from_s, double to_s, const ImuNoise& noise,
                                                  std::mt19937& random) const {
  std::vector<ImuInterval> readings;
  double at_s = from_s;
  for (const ImuSample& sample : samples(from_s, to_s, noise, random)) {
    readings.push_back({.from = from_seconds(at_s),
                        .to = from_seconds(at_s + sample.dt_s),
                        .angular_rate_rad_s = sample.angular_rate_rad_s,
                        .specific_force_m_s2 = sample.specific_force_m_s2});
    at_s += sample.dt_s;
  }
  return readings;
}

std::vector<Eigen::Vector3d> points_in_view(const HandHeldMotion& motion, int count,
                                            std::mt19937& random) {
  std::uniform_real_distribution<double> across(-0.8, 0.8);
  std::uniform_real_distribution<double> depth_m(2, 8);
  const RigidTransform world_from_camera =
      motion.state(0).world_from_imu * motion.extrinsics.imu_from_camera;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d ray(across(random), across(random), 1);
    points.push_back(world_from_camera * (depth_m(random) * ray).eval());
  }
  return points;
}

std::vector<FeatureObservation> observe(const HandHeldMotion& motion, double t_s,
                                        std::span<const Eigen::Vector3d> points, double sigma,
                                        std::mt19937& random) {
  constexpr double kFieldOfView = 0.9;
  std::normal_distribution<double> normal(0, sigma);
  const RigidTransform camera_from_world =
      (motion.state(t_s).world_from_imu * motion.extrinsics.imu_from_camera).inverse();
  std::vector<FeatureObservation> features;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d x = camera_from_world * points[i];
    if (!(x.z() > 0.1) || x.hnormalized().cwiseAbs().maxCoeff() > kFieldOfView) continue;
    features.push_back(
        {.track_id = static_cast<std::int64_t>(i),
         .bearing = x.hnormalized() + Eigen::Vector2d(normal(random), normal(random)),
         .covariance = sigma * sigma * Eigen::Matrix2d::Identity()});
  }
  return features;
}

}  // namespace stillkite
