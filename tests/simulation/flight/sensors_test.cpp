#include <gtest/gtest.h>

#include <cmath>

#include "simulation/flight/flight.hpp"
#include "simulation/flight/sensors.hpp"

namespace stillkite {
namespace {

constexpr ImuConfig kPerfectImu{.rate_hz = 400,
                                .gyro_noise_density = 0,
                                .gyro_bias_rad_s = 0,
                                .gyro_bias_walk = 0,
                                .accel_noise_density = 0,
                                .accel_bias_m_s2 = 0,
                                .accel_bias_walk = 0};

// Dead reckoning with an error-free IMU reproduces the trajectory.
TEST(Imu, IntegratesToTrajectory) {
  FlightConfig flight{
      .duration_s = 20, .height_m = 50, .forward_m = 100, .left_m = 20, .climb_m = -10};
  flight.tilt_sway_deg = 10;
  const Trajectory trajectory = make_trajectory(flight, 3);
  const std::vector<ImuReading> imu = simulate_imu(trajectory, kPerfectImu, 20, 1);
  ASSERT_EQ(imu.size(), 8001u);
  RigidTransform pose = trajectory.at(0).world_from_body;
  Eigen::Vector3d velocity = trajectory.at(0).velocity_in_world_m_s;
  for (std::size_t k = 1; k < imu.size(); ++k) {
    const double step_s = seconds_between(imu[k - 1].stamp, imu[k].stamp);
    const Eigen::Vector3d rate =
        0.5 * (imu[k - 1].angular_rate_in_body_rad_s + imu[k].angular_rate_in_body_rad_s);
    const Eigen::Quaterniond next = (pose.rotation * so3_exp(step_s * rate)).normalized();
    const Eigen::Vector3d acceleration =
        0.5 * (pose.rotation * imu[k - 1].specific_force_in_body_m_s2 +
               next * imu[k].specific_force_in_body_m_s2) -
        Eigen::Vector3d(0, 0, 9.80665);
    pose.translation += step_s * velocity + 0.5 * step_s * step_s * acceleration;
    velocity += step_s * acceleration;
    pose.rotation = next;
  }
  const MotionState end = trajectory.at(20);
  EXPECT_LT((pose.translation - end.world_from_body.translation).norm(), 2e-3);
  EXPECT_LT((velocity - end.velocity_in_world_m_s).norm(), 1e-3);
  EXPECT_LT(angle_between_rad(pose.rotation, end.world_from_body.rotation), 1e-5);
}

TEST(Imu, NoiseHasConfiguredDensity) {
  FlightConfig still{.duration_s = 100, .forward_m = 0, .left_m = 0, .climb_m = 0};
  still.sway_m = still.tilt_sway_deg = still.yaw_sway_deg = 0;
  ImuConfig config = kPerfectImu;
  config.gyro_noise_density = 1e-3;
  config.accel_noise_density = 2e-2;
  double gyro = 0;
  double accel = 0;
  const auto imu = simulate_imu(make_trajectory(still, 1), config, 100, 5);
  for (const ImuReading& reading : imu) {
    gyro += reading.angular_rate_in_body_rad_s.squaredNorm();
    accel += (reading.specific_force_in_body_m_s2 - Eigen::Vector3d(0, 0, 9.80665)).squaredNorm();
  }
  const double count = 3.0 * static_cast<double>(imu.size());
  EXPECT_NEAR(std::sqrt(gyro / count / 400), 1e-3, 1e-5);
  EXPECT_NEAR(std::sqrt(accel / count / 400), 2e-2, 2e-4);
}

// The end point of the measured range lies on the ground, flat or with relief.
TEST(RangeFinder, MeasuresDistanceToGround) {
  FlightConfig flight;
  flight.tilt_sway_deg = 10;
  const Trajectory trajectory = make_trajectory(flight, 3);
  const RangeConfig perfect{.rate_hz = 5, .noise_m = 0};
  const Relief relief({.amplitude_m = 20, .correlation_length_m = 40}, 9);
  const std::vector<RangeReading> flat = simulate_range(trajectory, nullptr, perfect, 150, 1);
  const std::vector<RangeReading> hilly = simulate_range(trajectory, &relief, perfect, 150, 1);
  ASSERT_EQ(flat.size(), 751u);
  ASSERT_EQ(hilly.size(), 751u);
  for (std::size_t k = 0; k < flat.size(); ++k) {
    const RigidTransform pose = trajectory.at(to_seconds(flat[k].stamp)).world_from_body;
    EXPECT_NEAR((pose * Eigen::Vector3d(0, 0, -flat[k].range_m)).z(), 0, 1e-6);
    const Eigen::Vector3d end = pose * Eigen::Vector3d(0, 0, -hilly[k].range_m);
    EXPECT_NEAR(end.z(), relief.height_m(end.x(), end.y()), 1e-6);
  }
}

TEST(Relief, IsBoundedSmoothAndPeriodic) {
  const Relief relief({.amplitude_m = 5, .correlation_length_m = 60}, 4);
  double peak = 0;
  double steepest = 0;
  for (double x_m = 0; x_m < 64 * 60; x_m += 1.9) {
    const double z_m = relief.height_m(x_m, 0.37 * x_m);
    peak = std::max(peak, std::abs(z_m));
    steepest = std::max(steepest, std::abs(relief.height_m(x_m + 1, 0.37 * x_m) - z_m));
  }
  EXPECT_LE(peak, 5.001);
  EXPECT_GT(peak, 1);
  EXPECT_LT(steepest, 0.3);
  EXPECT_NEAR(relief.height_m(123.4, -77), relief.height_m(123.4 + 64 * 60, -77 - 64 * 60), 1e-6);
}

}  // namespace
}  // namespace stillkite
