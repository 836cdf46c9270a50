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

/// Defaults: a consumer MEMS sensor.
struct ImuConfig {
  double rate_hz = 200;
  double gyro_noise_density = 1.7e-4;
  double gyro_bias_rad_s = 2e-3;
  double gyro_bias_walk = 2e-5;
  double accel_noise_density = 2e-3;
  double accel_bias_m_s2 = 0.02;
  double accel_bias_walk = 3e-3;

  static void fields(auto& self, auto&& field) {
    field("rate_hz", self.rate_hz, Range{1, 10000}, "sampling rate");
    field("gyro_noise_density", self.gyro_noise_density, kNonNegative,
          "white noise of the angular rate, rad/s/sqrt(Hz)");
    field("gyro_bias_rad_s", self.gyro_bias_rad_s, kNonNegative, "initial bias per axis, 1 sigma");
    field("gyro_bias_walk", self.gyro_bias_walk, kNonNegative,
          "random walk of the gyroscope bias, rad/s^2/sqrt(Hz)");
    field("accel_noise_density", self.accel_noise_density, kNonNegative,
          "white noise of the specific force, m/s^2/sqrt(Hz)");
    field("accel_bias_m_s2", self.accel_bias_m_s2, kNonNegative, "initial bias per axis, 1 sigma");
    field("accel_bias_walk", self.accel_bias_walk, kNonNegative,
          "random walk of the accelerometer bias, m/s^3/sqrt(Hz)");
  }
};

struct ImuReading {
  Timestamp stamp;
  Eigen::Vector3d angular_rate_in_body_rad_s;
  Eigen::Vector3d specific_force_in_body_m_s2;
};

/// Random-walk biases and white noise of one IMU. Precondition: readings at the configured rate.
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

[[nodiscard]] inline Eigen::Vector3d gravity_in_world_m_s2() {
  return {0, 0, -kGravity_m_s2};
}

struct RangeConfig {
  double rate_hz = 20;
  double noise_m = 0.05;

  static void fields(auto& self, auto&& field) {
    field("rate_hz", self.rate_hz, Range{0.01, 1000}, "sampling rate");
    field("noise_m", self.noise_m, kNonNegative, "white noise of a sample, 1 sigma");
  }
};

struct RangeReading {
  Timestamp stamp;
  double range_m = 0;  ///< distance to the ground along -z of the body
};

/// Readings of an IMU at the body origin from time 0 to `duration_s`: angular rate w + b + n,
/// specific force R^T (a - g) + b + n, with R = world_from_body and random-walk biases b.
[[nodiscard]] std::vector<ImuReading> simulate_imu(const Trajectory& trajectory,
                                                   const ImuConfig& config, double duration_s,
                                                   std::uint64_t seed);

/// Readings of a range finder along -z of the body; none if the ray misses the ground.
/// `relief`: null for flat ground.
[[nodiscard]] std::vector<RangeReading> simulate_range(const Trajectory& trajectory,
                                                       const Relief* relief,
                                                       const RangeConfig& config, double duration_s,
                                                       std::uint64_t seed);

}  // namespace stillkite
