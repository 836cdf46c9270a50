#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/fields.hpp"
#include "geometry/gravity.hpp"
#include "geometry/time.hpp"
#include "simulation/flight/trajectory.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/relief.hpp"

namespace stillkite {

/// The defaults are a consumer MEMS sensor's.
struct ImuConfig {
  double rate_hz = 200;
  double gyro_noise_density = 1.7e-4;
  double gyro_bias_rad_s = 2e-3;
  double gyro_bias_walk = 2e-5;
  double accel_noise_density = 2e-3;
  double accel_bias_m_s2 = 0.02;
  double accel_bias_walk = 3e-3;

  static void fields(auto& self, auto&& field) {
    field("rate_hz", self.rate_hz, Range{1, 10000}, "samples a second");
    field("gyro_noise_density", self.gyro_noise_density, kNotNegative, "rad/s/sqrt(Hz)");
    field("gyro_bias_rad_s", self.gyro_bias_rad_s, kNotNegative, "of the first bias, 1 sigma");
    field("gyro_bias_walk", self.gyro_bias_walk, kNotNegative, "rad/s^2/sqrt(Hz)");
    field("accel_noise_density", self.accel_noise_density, kNotNegative, "m/s^2/sqrt(Hz)");
    field("accel_bias_m_s2", self.accel_bias_m_s2, kNotNegative, "of the first bias, 1 sigma");
    field("accel_bias_walk", self.accel_bias_walk, kNotNegative, "m/s^3/sqrt(Hz)");
  }
};

struct ImuReading {
  Timestamp stamp;
  Eigen::Vector3d angular_rate_in_body_rad_s;
  Eigen::Vector3d specific_force_in_body_m_s2;
};

/// Biases that walk randomly, and white noise, of one IMU; readings are to come at its rate.
class ImuErrors {
 public:
  ImuErrors(const ImuConfig& config, std::uint64_t seed);

  [[nodiscard]] ImuReading add_to(const ImuReading& exact);

 private:
  ImuConfig config_;
  Random random_;
  Eigen::Vector3d gyro_bias_rad_s_;
  Eigen::Vector3d accel_bias_m_s2_;
};

/// Accelerometers feel its opposite.
[[nodiscard]] inline Eigen::Vector3d gravity_in_world_m_s2() {
  return {0, 0, -kGravity_m_s2};
}

struct RangeConfig {
  double rate_hz = 20;
  double noise_m = 0.05;

  static void fields(auto& self, auto&& field) {
    field("rate_hz", self.rate_hz, Range{0.01, 1000}, "samples a second");
    field("noise_m", self.noise_m, kNotNegative, "1 sigma of a sample");
  }
};

struct RangeReading {
  Timestamp stamp;
  double range_m = 0;  ///< from the body to the ground along the body's -z
};

/// IMU at the body's origin: rate w + b + n, specific force R^T (a - g) + b + n, from time 0 to the
/// duration. The biases walk randomly.
[[nodiscard]] std::vector<ImuReading> simulate_imu(const Trajectory& trajectory,
                                                   const ImuConfig& config, double duration_s,
                                                   std::uint64_t seed);

/// Range finder that looks along -z of the body; no reading where it does not meet the ground.
/// `relief`: null for a flat ground.
[[nodiscard]] std::vector<RangeReading> simulate_range(const Trajectory& trajectory,
                                                       const Relief* relief,
                                                       const RangeConfig& config, double duration_s,
                                                       std::uint64_t seed);

}  // namespace stillkite
