#include "simulation/flight/sensors.hpp"

#include <cmath>
#include <optional>

#include "simulation/random.hpp"

namespace stillkite {
namespace {

Eigen::Vector3d normal_vector(double deviation, Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return deviation * Eigen::Vector3d(x, y, z);
}

// First intersection of a ray with the ground: steps below the clearance (valid for slopes up to
// about 1), then bisection. Nullopt for a nearly horizontal or upward ray.
std::optional<double> range_along(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray,
                                  const Relief* relief) {
  if (ray.z() > -0.05) return std::nullopt;
  const auto clearance = [&](double range) {
    const Eigen::Vector3d x = origin + range * ray;
    return x.z() - (relief ? relief->height_m(x.x(), x.y()) : 0.0);
  };
  const double peak = relief ? relief->amplitude_m() : 0.0;
  const double max_range = (origin.z() + peak + 1) / -ray.z();
  double near = 0;
  double far = std::max(0.0, (origin.z() - peak) / -ray.z());
  while (far < max_range && clearance(far) > 0) {
    near = far;
    far += 0.3 * clearance(far) + 0.05;
  }
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (near + far);
    (clearance(middle) > 0 ? near : far) = middle;
  }
  return 0.5 * (near + far);
}

}  // namespace

ImuErrors::ImuErrors(const ImuConfig& config, std::uint64_t seed)
    : config_(config),
      random_(seed, 2000),
      gyro_bias_rad_s_(normal_vector(config.gyro_bias_rad_s, random_)),
      accel_bias_m_s2_(normal_vector(config.accel_bias_m_s2, random_)) {}

ImuReading ImuErrors::add_to(const ImuReading& exact) {
  const double root_rate = std::sqrt(config_.rate_hz);
  const ImuReading reading{exact.stamp,
                           exact.angular_rate_in_body_rad_s + gyro_bias_rad_s_ +
                               normal_vector(config_.gyro_noise_density * root_rate, random_),
                           exact.specific_force_in_body_m_s2 + accel_bias_m_s2_ +
                               normal_vector(config_.accel_noise_density * root_rate, random_)};
  gyro_bias_rad_s_ += normal_vector(config_.gyro_bias_walk / root_rate, random_);
  accel_bias_m_s2_ += normal_vector(config_.accel_bias_walk / root_rate, random_);
  return reading;
}

std::vector<ImuReading> simulate_imu(const Trajectory& trajectory, const ImuConfig& config,
                                     double duration_s, std::uint64_t seed) {
  ImuErrors errors(config, seed);
  std::vector<ImuReading> readings;
  const auto count = static_cast<std::int64_t>(std::floor(duration_s * config.rate_hz + 1e-9)) + 1;
  for (std::int64_t k = 0; k < count; ++k) {
    const double t_s = static_cast<double>(k) / config.rate_hz;
    const MotionState state = trajectory.at(t_s);
    const Eigen::Vector3d specific_force =
        state.world_from_body.rotation.conjugate() *
        (state.acceleration_in_world_m_s2 - gravity_in_world_m_s2());
    readings.push_back(
        errors.add_to({from_seconds(t_s), state.angular_rate_in_body_rad_s, specific_force}));
  }
  return readings;
}

std::vector<RangeReading> simulate_range(const Trajectory& trajectory, const Relief* relief,
                                         const RangeConfig& config, double duration_s,
                                         std::uint64_t seed) {
  Random random(seed, 2001);
  std::vector<RangeReading> readings;
  const auto count = static_cast<std::int64_t>(std::floor(duration_s * config.rate_hz + 1e-9)) + 1;
  for (std::int64_t k = 0; k < count; ++k) {
    const double t_s = static_cast<double>(k) / config.rate_hz;
    const RigidTransform pose = trajectory.at(t_s).world_from_body;
    const auto range =
        range_along(pose.translation, pose.rotation * -Eigen::Vector3d::UnitZ(), relief);
    const double noise_m = config.noise_m * random.normal();
    if (range) readings.push_back({from_seconds(t_s), *range + noise_m});
  }
  return readings;
}

}  // namespace stillkite
