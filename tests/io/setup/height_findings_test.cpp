#include "io/setup/height_findings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "geometry/gravity.hpp"
#include "navigation/sensor_readings.hpp"

namespace stillkite {
namespace {

using Eigen::Vector3d;

constexpr double kFrame_s = 1.0 / 30;

Vector3d position_m(double t_s) {
  return {3 * t_s + std::sin(1.1 * t_s), std::cos(0.9 * t_s), 10 + 1.5 * std::sin(0.4 * t_s)};
}
Vector3d velocity_m_s(double t_s) {
  return {3 + 1.1 * std::cos(1.1 * t_s), -0.9 * std::sin(0.9 * t_s), 0.6 * std::cos(0.4 * t_s)};
}
Vector3d acceleration_m_s2(double t_s) {
  return {-1.21 * std::sin(1.1 * t_s), -0.81 * std::cos(0.9 * t_s), -0.24 * std::sin(0.4 * t_s)};
}
Eigen::Quaterniond attitude(double t_s) {
  return so3_exp({0.1 * std::sin(t_s), 0.08 * std::cos(1.3 * t_s), 0.05 * t_s});
}

// 25 s; `unit`: metres per unit of the flow's lengths.
std::vector<FlowMotion> flow_in(double unit, double velocity_sigma_m_s = 0.01) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, velocity_sigma_m_s);
  std::vector<FlowMotion> out;
  for (int i = 0; i < 750; ++i) {
    const double t_s = kFrame_s * i;
    const Vector3d error(noise(random), noise(random), noise(random));
    out.push_back({.stamp = from_seconds(t_s),
                   .world_from_body = {attitude(t_s), position_m(t_s) / unit},
                   .velocity_in_world = (velocity_m_s(t_s) + error) / unit,
                   .velocity_sigma = velocity_sigma_m_s / unit});
  }
  return out;
}

TimeSeries<Vector6d> imu() {
  TimeSeries<Vector6d> out;
  for (int i = 0; i < 5000; ++i) {
    const double t_s = 0.005 * i;
    Vector6d value;
    value << Vector3d::Zero(),
        attitude(t_s).conjugate() * (acceleration_m_s2(t_s) + Vector3d(0, 0, kGravity_m_s2)) +
            Vector3d(0.1, -0.2, 0.15);
    out.stamps.push_back(from_seconds(t_s));
    out.values.push_back(value);
  }
  return out;
}

TEST(HeightFindings, ScaleByForcesIsThatOfTheFlow) {
  for (const double unit : {1.0, 10.0, 0.3048}) {
    const auto scale = inertial_scale(flow_in(unit), imu());
    ASSERT_TRUE(scale) << unit;
    EXPECT_NEAR(scale->value, unit, 0.02 * unit);
    EXPECT_LT(scale->sigma, 0.02 * unit);
  }
}

TEST(HeightFindings, NoScaleByForcesFromNoisyVelocities) {
  EXPECT_FALSE(inertial_scale(flow_in(1, 0.5), imu()));
}

TEST(HeightFindings, ScaleByTheTruthsDisplacementsNeedsNoCommonFrame) {
  GroundTruth truth;
  const Eigen::Quaterniond yaw = so3_exp({0, 0, 1.3});
  for (int i = 0; i < 130; ++i) {
    truth.poses.push_back(
        {from_seconds(0.2 * i),
         {Eigen::Quaterniond::Identity(), yaw * position_m(0.2 * i) + Vector3d(7, 8, 9)}});
  }
  const auto scale = scale_of_truth(flow_in(10), truth);
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->value, 10, 0.1);
  GroundTruth velocities;
  for (int i = 0; i < 130; ++i) {
    velocities.velocities.push_back({from_seconds(0.2 * i), velocity_m_s(0.2 * i)});
  }
  const auto by_velocity = scale_of_truth(flow_in(10), velocities);
  ASSERT_TRUE(by_velocity);
  EXPECT_NEAR(by_velocity->value, 10, 0.1);
}

TEST(HeightFindings, NamesFeet) {
  const SetupFinding feet = height_finding(32.8, BlockEstimate{0.305, 0.01}, "x");
  EXPECT_EQ(feet.verdict, SetupVerdict::wrong);
  EXPECT_NE(feet.text.find("feet instead of metres"), std::string::npos) << feet.text;
  EXPECT_EQ(feet.remedy, "initial: {height_m: 10}");
}

TEST(HeightFindings, AccusesNoHeightWithinFiveSigma) {
  EXPECT_EQ(height_finding(10, BlockEstimate{1.3, 0.07}, "x").verdict, SetupVerdict::cannot_tell);
  EXPECT_EQ(height_finding(10, BlockEstimate{1.3, 0.05}, "x").verdict, SetupVerdict::doubtful);
  EXPECT_EQ(height_finding(10, BlockEstimate{1.1, 0.001}, "x").verdict, SetupVerdict::ok);
  EXPECT_EQ(height_finding(10, std::nullopt, "x").verdict, SetupVerdict::cannot_tell);
  EXPECT_EQ(height_finding(10, BlockEstimate{0.3, 0.1}, "x").verdict, SetupVerdict::cannot_tell);
}

SensorLog height_log(ScaleSource source, double factor, double offset) {
  SensorLog log;
  log.height_source = source;
  for (int i = 0; i < 250; ++i) {
    const double t_s = 0.1 * i;
    const double tilt = (attitude(t_s) * Vector3d::UnitZ()).z();
    const double z_m = position_m(t_s).z();
    log.height_m.stamps.push_back(from_seconds(t_s));
    log.height_m.values.push_back(factor * (source == ScaleSource::range ? z_m / tilt : z_m) +
                                  offset);
  }
  return log;
}

TEST(HeightFindings, BarometerInFeetChangesByTooMuch) {
  const auto finding = [](double factor) {
    return height_sensor_finding(flow_in(1), height_log(ScaleSource::barometer, factor, 300), 10);
  };
  EXPECT_EQ(finding(1).verdict, SetupVerdict::ok) << finding(1).text;
  EXPECT_EQ(finding(1 / 0.3048).verdict, SetupVerdict::wrong);
  EXPECT_NE(finding(1 / 0.3048).text.find("feet"), std::string::npos) << finding(1 / 0.3048).text;
  EXPECT_NE(finding(-1).text.find("positive down"), std::string::npos) << finding(-1).text;
}

TEST(HeightFindings, RangeInFeetContradictsTheInitialHeight) {
  const auto finding = [](double factor) {
    return height_sensor_finding(flow_in(1), height_log(ScaleSource::range, factor, 0), 10);
  };
  EXPECT_EQ(finding(1).verdict, SetupVerdict::ok) << finding(1).text;
  EXPECT_NE(finding(1 / 0.3048).text.find("feet"), std::string::npos) << finding(1 / 0.3048).text;
}

// The unit of a range alone is not observable: flow and sensor have it in common.
TEST(HeightFindings, RangeWithAnOffsetIsFoundInAnyUnit) {
  const auto finding = [](double offset) {
    return height_sensor_finding(flow_in(0.3048),
                                 height_log(ScaleSource::range, 1 / 0.3048, offset), std::nullopt);
  };
  EXPECT_EQ(finding(0).verdict, SetupVerdict::ok) << finding(0).text;
  EXPECT_EQ(finding(15).verdict, SetupVerdict::doubtful) << finding(15).text;
}

TEST(HeightFindings, CannotTellFromAConstantHeight) {
  std::vector<FlowMotion> flow = flow_in(1);
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 0.02);
  SensorLog log = height_log(ScaleSource::barometer, 0, 10);
  for (FlowMotion& motion : flow) motion.world_from_body.translation.z() = 10 + noise(random);
  for (double& value : log.height_m.values) value += noise(random);
  EXPECT_EQ(height_sensor_finding(flow, log, 10).verdict, SetupVerdict::cannot_tell);
}

}  // namespace
}  // namespace stillkite
