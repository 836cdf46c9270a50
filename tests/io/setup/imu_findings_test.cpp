#include "io/setup/imu_findings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/angle.hpp"
#include "geometry/gravity.hpp"

namespace stillkite {
namespace {

using Eigen::Vector3d;

// 20 s of 200 readings per second at rest, z up.
TimeSeries<Vector6d> log_at_rest(double gyro_sigma = 0.01, double accel_sigma = 0.1) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 1);
  TimeSeries<Vector6d> imu;
  for (int i = 0; i < 4000; ++i) {
    imu.stamps.push_back(from_seconds(0.005 * i));
    Vector6d value;
    for (int axis = 0; axis < 6; ++axis) {
      value(axis) = (axis < 3 ? gyro_sigma : accel_sigma) * noise(random);
    }
    value(5) += kGravity_m_s2;
    imu.values.push_back(value);
  }
  return imu;
}

void scale_forces(TimeSeries<Vector6d>& imu, double factor) {
  for (Vector6d& value : imu.values) value.tail<3>() *= factor;
}

TEST(ImuFindings, DensityOfWhiteNoiseIsSigmaOverRootRate) {
  const auto densities = measured_densities(log_at_rest());
  ASSERT_TRUE(densities);
  EXPECT_NEAR(densities->gyro, 0.01 / std::sqrt(200), 0.02 * 0.01 / std::sqrt(200));
  EXPECT_NEAR(densities->accel, 0.1 / std::sqrt(200), 0.02 * 0.1 / std::sqrt(200));
}

TEST(ImuFindings, NoiseIsDoubtfulAboveTenTimesTheConfiguredDensity) {
  const TimeSeries<Vector6d> imu = log_at_rest();
  const double gyro = 0.01 / std::sqrt(200), accel = 0.1 / std::sqrt(200);
  EXPECT_EQ(imu_noise_finding(imu, {gyro / 9, accel / 9}).verdict, SetupVerdict::ok);
  const SetupFinding noisy = imu_noise_finding(imu, {gyro / 11, accel});
  EXPECT_EQ(noisy.verdict, SetupVerdict::doubtful);
  EXPECT_EQ(noisy.remedy, "imu: {noise: {gyro_density: 0.00071, accel_density: 0.0071}}");
}

TEST(ImuFindings, NamesTheUnitOfTheSpecificForce) {
  TimeSeries<Vector6d> imu = log_at_rest();
  EXPECT_EQ(gravity_size_finding(imu).verdict, SetupVerdict::ok);
  scale_forces(imu, 1 / kGravity_m_s2);
  const SetupFinding in_g = gravity_size_finding(imu);
  EXPECT_EQ(in_g.verdict, SetupVerdict::wrong);
  EXPECT_NE(in_g.text.find("the unit is g instead of m/s^2"), std::string::npos) << in_g.text;
  EXPECT_EQ(in_g.remedy, "multiply ax, ay, az of the log by 9.80665");
}

TEST(ImuFindings, AScaleErrorOfTenPercentIsDoubtful) {
  TimeSeries<Vector6d> imu = log_at_rest();
  scale_forces(imu, 1.1);
  EXPECT_EQ(gravity_size_finding(imu).verdict, SetupVerdict::doubtful);
}

// Seconds of different magnitude: a circular flight.
TEST(ImuFindings, AVaryingForceOfSixPercentMoreIsNoScaleError) {
  TimeSeries<Vector6d> imu = log_at_rest();
  for (std::size_t i = 0; i < imu.values.size(); ++i) {
    imu.values[i].tail<3>() *= 1.06 + 0.2 * std::sin(0.005 * static_cast<double>(i));
  }
  EXPECT_EQ(gravity_size_finding(imu).verdict, SetupVerdict::cannot_tell);
}

TEST(ImuFindings, DetectsForcesBeforeRates) {
  const TimeSeries<Vector6d> imu = log_at_rest();
  EXPECT_FALSE(has_swapped_columns(imu));
  const TimeSeries<Vector6d> swapped = with_swapped_columns(imu);
  EXPECT_EQ(swapped.values[7](2), imu.values[7](5));
  EXPECT_EQ(swapped.values[7](3), imu.values[7](0));
  EXPECT_TRUE(has_swapped_columns(swapped));
}

// Rotation about x at 0.2 rad/s, accelerated at random about gravity.
TEST(ImuFindings, UpDirectionIsThatOfTheFirstFrame) {
  const Vector3d rate(0.2, 0, 0), bias(0.05, -0.03, 0.08);
  TimeSeries<Vector6d> imu = log_at_rest(0.001, 0.5);
  for (std::size_t i = 0; i < imu.values.size(); ++i) {
    const double t_s = 0.005 * static_cast<double>(i);
    Vector6d& value = imu.values[i];
    value.head<3>() += rate + bias;
    value.tail<3>() = so3_exp(-t_s * rate) * value.tail<3>();
  }
  const auto up = up_direction(imu, from_seconds(0), bias);
  ASSERT_TRUE(up);
  EXPECT_LT(angle_between_rad(up->up_in_body, Vector3d(Vector3d::UnitZ())), 0.1 * kDegree);
  EXPECT_NEAR(up->duration_s, 10, 0.5);
}

TEST(ImuFindings, ComparesGravityWithTheInitialAttitude) {
  const auto up = up_direction(log_at_rest(), from_seconds(0), Vector3d(Vector3d::Zero()));
  ASSERT_TRUE(up);
  const auto finding = [&](double roll_deg) {
    return initial_attitude_finding(*up, so3_exp({roll_deg * kDegree, 0, 0}), "initial.roll_deg");
  };
  EXPECT_EQ(finding(4).verdict, SetupVerdict::ok);
  EXPECT_EQ(finding(8).verdict, SetupVerdict::doubtful);
  EXPECT_NEAR(finding(8).measured->value, 8, 0.2);
  EXPECT_EQ(finding(180).verdict, SetupVerdict::wrong);
  EXPECT_EQ(finding(8).remedy.find("initial: {roll_deg: "), 0u) << finding(8).remedy;
}

}  // namespace
}  // namespace stillkite
