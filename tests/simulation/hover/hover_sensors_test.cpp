#include <gtest/gtest.h>

#include <cmath>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/hover/hover_sensors.hpp"
#include "simulation/hover/plant_config.hpp"

namespace stillkite {
namespace {

constexpr ImuConfig kExactImu{.rate_hz = 200,
                              .gyro_noise_density = 0,
                              .gyro_bias_rad_s = 0,
                              .gyro_bias_walk = 0,
                              .accel_noise_density = 0,
                              .accel_bias_m_s2 = 0,
                              .accel_bias_walk = 0};

HoverSensorConfig exact_sensors() {
  HoverSensorConfig config{.imu = kExactImu, .height_error_ratio = 0};
  config.tether.length_noise_m = config.tether.angle_noise_deg = 0;
  config.attitude.tilt_noise_deg = config.attitude.yaw_noise_deg = 0;
  config.attitude.yaw_drift_deg_per_min = 0;
  return config;
}

Timestamp step_stamp(int step) {
  return {step * std::int64_t{5'000'000}};
}

// Readings of a drone at rest.
HoverReadings readings_at_rest(const HoverSensorConfig& config, std::uint64_t seed, int steps) {
  const TetheredDrone drone({}, camera_raised_forward(75), {}, 0.4);
  HoverSensors sensors(config, seed);
  HoverReadings all;
  for (int k = 0; k <= steps; ++k) {
    const HoverReadings now = sensors.read(drone.truth(), step_stamp(k));
    all.tether.insert(all.tether.end(), now.tether.begin(), now.tether.end());
    all.attitude.insert(all.attitude.end(), now.attitude.begin(), now.attitude.end());
  }
  return all;
}

TEST(HoverSensors, HaveConfiguredRatesAndLatency) {
  const HoverReadings readings = readings_at_rest({}, 1, 2000);
  ASSERT_EQ(readings.tether.size(), 501u);
  ASSERT_EQ(readings.attitude.size(), 2001u);
  for (std::size_t k = 0; k < readings.tether.size(); ++k) {
    EXPECT_EQ(readings.tether[k].stamp.ns, static_cast<std::int64_t>(k) * 20'000'000);
    EXPECT_EQ(readings.tether[k].available.ns - readings.tether[k].stamp.ns, 5'000'000);
  }
  EXPECT_EQ(readings.attitude[7].stamp.ns, 35'000'000);
}

TEST(HoverSensors, HaveConfiguredNoiseAndDrift) {
  HoverSensorConfig config;
  config.imu = kExactImu;
  const HoverReadings readings = readings_at_rest(config, 5, 60 * 200);
  double length = 0, angle = 0;
  for (const TetherSample& reading : readings.tether) {
    length += std::pow(reading.tether.length_m - 2, 2);
    angle += std::pow(reading.tether.azimuth_rad, 2);
  }
  const auto count = static_cast<double>(readings.tether.size());
  EXPECT_NEAR(std::sqrt(length / count), 0.003, 0.003 * 3 / std::sqrt(2 * count));
  EXPECT_NEAR(std::sqrt(angle / count), 0.3 * kDegree, 0.3 * kDegree * 3 / std::sqrt(2 * count));
  const auto yaw_deg = [&](std::size_t first) {
    double sum = 0;
    for (std::size_t k = first; k < first + 200; ++k) {
      sum += to_euler(readings.attitude[k].world_from_body).yaw_rad / kDegree / 200;
    }
    return sum;
  };
  EXPECT_NEAR(std::abs(yaw_deg(60 * 200 - 200) - yaw_deg(0)), 0.5 * 59 / 60, 0.02);
  double height_error = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    height_error += std::pow(HoverSensors({}, seed).measured_height_m(3) / 3 - 1, 2) / 2000;
  }
  EXPECT_NEAR(std::sqrt(height_error), 0.02, 0.001);
}

// Dead reckoning with error-free readings reproduces the motion, including motion between readings.
TEST(HoverSensors, IntegrateToDroneMotion) {
  const StationPath path({}, PaperAxis::z);
  TetheredDrone drone({}, camera_raised_forward(75), path.at(0), 0.2);
  HoverSensors sensors(exact_sensors(), 1);
  (void)sensors.read(drone.truth(), step_stamp(0));
  Eigen::Vector3d position = drone.truth().world_from_body.translation;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Quaterniond attitude = drone.truth().world_from_body.rotation;
  double yaw_rad = 0.2;
  for (int k = 1; k <= 2400; ++k) {
    const TetherCommand command{0.1 * std::sin(0.01 * k), -0.05, 0.08, 0.3 * std::cos(0.02 * k)};
    Disturbance disturbance{.wind_in_world_m_s = {3 * std::sin(0.003 * k), 1, 0}};
    drone.step(command, disturbance, path.at(0.005 * k - 0.003), 0.002);
    disturbance.yaw_kick_rad = k % 500 == 0 ? 20 * kDegree : 0;
    ASSERT_TRUE(sensors.read(drone.truth(), {step_stamp(k).ns - 3'000'000}).attitude.empty());
    drone.step(command, disturbance, path.at(0.005 * k - 0.001), 0.002);
    disturbance.yaw_kick_rad = 0;
    drone.step(command, disturbance, path.at(0.005 * k), 0.001);
    const HoverReadings now = sensors.read(drone.truth(), step_stamp(k));
    const AttitudeReading& imu = now.attitude.front();
    const Eigen::Quaterniond half_way = attitude.slerp(0.5, imu.world_from_body);
    attitude = imu.world_from_body;
    // initial velocity step by the wind
    if (k == 1) velocity = drone.truth().velocity_in_world_m_s;
    const Eigen::Vector3d change =
        0.005 * (half_way * imu.specific_force_in_body_m_s2 - Eigen::Vector3d(0, 0, 9.80665));
    position += 0.005 * (velocity + 0.5 * change);
    velocity += change;
    yaw_rad += 0.005 * imu.angular_rate_in_body_rad_s.z();
    if (now.tether.empty()) continue;
    ASSERT_EQ(now.tether.front().tether.length_m, drone.truth().tether.length_m);
  }
  EXPECT_LT((velocity - drone.truth().velocity_in_world_m_s).norm(), 1e-9);
  EXPECT_LT((position - drone.truth().world_from_body.translation).norm(), 5e-4);
  EXPECT_NEAR(yaw_rad, to_euler(drone.truth().world_from_body.rotation).yaw_rad, 1e-9);
}

// Rate and noise of one sensor do not change the random numbers of another.
TEST(HoverSensors, UseIndependentRandomStreams) {
  HoverSensorConfig config;
  const HoverReadings one = readings_at_rest(config, 3, 400);
  config.imu.rate_hz = 100;
  const HoverReadings slower = readings_at_rest(config, 3, 400);
  ASSERT_EQ(one.tether.size(), slower.tether.size());
  for (std::size_t k = 0; k < one.tether.size(); ++k) {
    EXPECT_EQ(one.tether[k].tether.length_m, slower.tether[k].tether.length_m);
  }
  EXPECT_EQ(slower.attitude.size(), 201u);
  EXPECT_NE(readings_at_rest(config, 4, 0).tether[0].tether.length_m,
            one.tether[0].tether.length_m);
}

}  // namespace
}  // namespace stillkite
