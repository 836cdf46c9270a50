#include "simulation/hover/sea_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/angle.hpp"
#include "simulation/flight/sensors.hpp"
#include "simulation/random.hpp"

namespace stillkite {
namespace {

Eigen::Vector2d horizontal_direction(double direction_rad) {
  return {std::cos(direction_rad), std::sin(direction_rad)};
}

// Quantile of the density 2/pi cos^2, whose cumulative distribution is
// (angle + sin cos) / pi + 1/2, by bisection.
double spread_angle_rad(double probability) {
  double low = -std::numbers::pi / 2;
  double high = std::numbers::pi / 2;
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (low + high);
    const double below = (middle + std::sin(middle) * std::cos(middle)) / std::numbers::pi + 0.5;
    (below < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double sinc(double x) {
  return std::abs(x) < 1e-6 ? 1 : std::sin(x) / x;
}

// Mean of a wave over the waterplane relative to the wave at its centre.
double waterplane_mean(const Eigen::Vector2d& wave_vector, const Waterplane& waterplane) {
  const Eigen::Vector2d ahead = waterplane.ahead_in_world;
  const Eigen::Vector2d across(-ahead.y(), ahead.x());
  return sinc(0.5 * waterplane.length_m * wave_vector.dot(ahead)) *
         sinc(0.5 * waterplane.beam_m * wave_vector.dot(across));
}

// Factor of the sea motion: 3 s^2 - 2 s^3 with s = t / 5 s, then 1.
struct SeaRise {
  double factor = 0;
  double rate_1_s = 0;
  double integral_s = 0;  // of the factor
};

SeaRise sea_rise_at(double t_s) {
  constexpr double kRise_s = 5;
  const double s = std::clamp(t_s / kRise_s, 0.0, 1.0);
  return {.factor = s * s * (3 - 2 * s),
          .rate_1_s = 6 * s * (1 - s) / kRise_s,
          .integral_s = kRise_s * s * s * s * (1 - 0.5 * s) + std::max(0.0, t_s - kRise_s)};
}

}  // namespace

std::vector<RegularWave> make_waves(const SeaConfig& config, std::uint64_t seed) {
  constexpr int kWaves = 60;
  const double gravity_m_s2 = gravity_in_world_m_s2().norm();
  const double peak_rad_s = 2 * std::numbers::pi / config.peak_period_s;
  const double amplitude_m = config.significant_height_m * std::sqrt(2.0 / 16 / kWaves);
  Random random(seed);
  std::vector<RegularWave> waves;
  waves.reserve(kWaves);
  for (int i = 0; i < kWaves; ++i) {
    const double probability = (i + 0.5) / kWaves;
    const double frequency_rad_s = peak_rad_s * std::pow(-1.25 / std::log(probability), 0.25);
    const double direction_rad = config.towards_deg * kDegree + spread_angle_rad(random.uniform());
    waves.push_back({.amplitude_m = amplitude_m,
                     .angular_frequency_rad_s = frequency_rad_s,
                     .wave_vector_rad_m = frequency_rad_s * frequency_rad_s / gravity_m_s2 *
                                          horizontal_direction(direction_rad),
                     .phase_rad = random.uniform(0, 2 * std::numbers::pi)});
  }
  return waves;
}

// With p = k . x - w t + phase: displacement (-a sin p k / |k|, a cos p), slope -a sin p k.
WaterMotion water_motion(const std::vector<RegularWave>& waves, const Waterplane& waterplane,
                         const Eigen::Vector2d& position_in_world_m,
                         const Eigen::Vector2d& position_velocity_in_world_m_s, double t_s) {
  WaterMotion motion;
  for (const RegularWave& wave : waves) {
    const Eigen::Vector2d& k = wave.wave_vector_rad_m;
    const double amplitude_m = wave.amplitude_m * waterplane_mean(k, waterplane);
    const double frequency_rad_s = wave.angular_frequency_rad_s;
    const double phase_rad = k.dot(position_in_world_m) - frequency_rad_s * t_s + wave.phase_rad;
    const double phase_rate_rad_s = k.dot(position_velocity_in_world_m_s) - frequency_rad_s;
    const Eigen::Vector2d direction = k.normalized();
    const double sine_m = amplitude_m * std::sin(phase_rad);
    const double cosine_m = amplitude_m * std::cos(phase_rad);
    motion.displacement_in_world_m.head<2>() -= sine_m * direction;
    motion.displacement_in_world_m.z() += cosine_m;
    motion.velocity_in_world_m_s.head<2>() -= phase_rate_rad_s * cosine_m * direction;
    motion.velocity_in_world_m_s.z() -= phase_rate_rad_s * sine_m;
    motion.slope -= sine_m * k;
  }
  return motion;
}

StationState station_on_boat(const StationState& on_land, const SeaConfig& config,
                             const std::vector<RegularWave>& waves, double t_s) {
  const RigidTransform& pose = on_land.world_from_station;
  const SeaRise rise = sea_rise_at(t_s);
  const Eigen::Vector2d drift_m_s =
      config.drift_m_s * horizontal_direction(config.towards_deg * kDegree);
  const Eigen::Vector3d ahead = pose.rotation * Eigen::Vector3d::UnitX();
  const WaterMotion water = water_motion(
      waves, {ahead.head<2>().normalized(), config.boat_length_m, config.boat_length_m / 3},
      pose.translation.head<2>() + rise.integral_s * drift_m_s,
      on_land.velocity_in_world_m_s.head<2>() + rise.factor * drift_m_s, t_s);

  StationState out = on_land;
  const Eigen::Vector3d up(-rise.factor * water.slope.x(), -rise.factor * water.slope.y(), 1);
  out.world_from_station.rotation = rotation_between(Eigen::Vector3d::UnitZ(), up) * pose.rotation;
  out.world_from_station.translation += rise.factor * water.displacement_in_world_m;
  out.world_from_station.translation.head<2>() += rise.integral_s * drift_m_s;
  out.velocity_in_world_m_s +=
      rise.factor * water.velocity_in_world_m_s + rise.rate_1_s * water.displacement_in_world_m;
  out.velocity_in_world_m_s.head<2>() += rise.factor * drift_m_s;
  return out;
}

}  // namespace stillkite
