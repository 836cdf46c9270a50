#include "navigation/inertial_findings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "../estimation/sliding_window/hand_held_motion.hpp"

namespace stillkite {
namespace {

struct FlightFaults {
  double time_offset_s = 0;
  double lever_arm_m = 0;
  double camera_rotation_rad = 0;
  double camera_roll_rad = 0;  // about the optical axis
  bool swaps_accelerometer_axes = false;
};

std::vector<InertialFinding> findings_of(const FlightFaults& faults, double duration_s = 8) {
  constexpr double kFrame_s = 0.05;
  const ImuNoise noise{
      .gyro_density = 2e-4, .accel_density = 2e-3, .gyro_bias_walk = 2e-5, .accel_bias_walk = 1e-4};
  std::mt19937 random(3);
  HandHeldMotion motion;
  motion.tilt_rad = 0.4;
  const auto points = points_in_view(motion, 200, random);
  SlidingWindow window(motion.extrinsics, motion.state(0).world_from_imu, noise, InertialPriors{});
  RigidTransform& mount = motion.extrinsics.imu_from_camera;
  mount.translation.y() += faults.lever_arm_m;
  mount.rotation =
      mount.rotation * so3_exp({faults.camera_rotation_rad, 0, faults.camera_roll_rad});
  double imu_s = 0;
  for (int frame = 0; kFrame_s * frame < duration_s; ++frame) {
    const double t_s = kFrame_s * frame;
    const double until_s = t_s + std::max(0.0, faults.time_offset_s);
    std::vector<ImuInterval> readings = motion.readings(imu_s, until_s, noise, random);
    imu_s = until_s;
    for (ImuInterval& reading : readings) {
      if (!faults.swaps_accelerometer_axes) break;
      std::swap(reading.specific_force_m_s2.x(), reading.specific_force_m_s2.y());
    }
    const auto features = observe(motion, t_s + faults.time_offset_s, points, 5e-4, random);
    window.add_frame(from_seconds(t_s), readings, features);
    if (frame % 5 == 0) window.take_keyframe(features);
  }
  return inertial_findings(window);
}

TEST(InertialFindings, NoneForARightCalibration) {
  EXPECT_TRUE(findings_of({}).empty());
}

TEST(InertialFindings, NamesTheClock) {
  const auto findings = findings_of({.time_offset_s = -0.03});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].fault, InertialFault::clock);
  EXPECT_NEAR(findings[0].value.x(), -0.03, 0.003);
}

TEST(InertialFindings, NamesTheLeverArm) {
  const auto findings = findings_of({.lever_arm_m = 0.2}, 6);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].fault, InertialFault::lever_arm);
}

TEST(InertialFindings, NamesTheRotationOfTheCamera) {
  const auto findings = findings_of({.camera_rotation_rad = 0.05});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].fault, InertialFault::camera_rotation);
  EXPECT_NEAR(findings[0].change.norm(), 0.05, 0.005);
}

// Until the accelerometer's bias contradicts its prior, or no motion is found.
TEST(InertialFindings, NamesAContradiction) {
  const auto findings = findings_of({.swaps_accelerometer_axes = true}, 3);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].fault, InertialFault::contradiction);
}

// All points fit with a camera that is rotated by 90 degrees: the axes of the IMU are wrong.
TEST(InertialFindings, RotationBeyondItsPriorIsAContradiction) {
  const auto findings = findings_of({.camera_roll_rad = 0.5 * std::numbers::pi});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].fault, InertialFault::contradiction);
}

TEST(InertialFindings, BiasBeyondItsPriorIsAContradiction) {
  InertialState state;
  state.accel_bias_m_s2 = {0.3, -0.3, 0.2};
  EXPECT_FALSE(contradicts_prior(state, {}));
  state.accel_bias_m_s2 = {0.8, -0.8, 0.5};
  EXPECT_TRUE(contradicts_prior(state, {}));
}

}  // namespace
}  // namespace stillkite
