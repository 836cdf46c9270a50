#include "geometry/euler.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/rigid_transform.hpp"
#include "tests/geometry/random_values.hpp"

namespace stillkite {
namespace {

using std::numbers::pi;

TEST(Euler, ComposesYawPitchRoll) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d a = random_vector(random, 3.0);
    const Eigen::Quaterniond expected =
        so3_exp({0, 0, a.x()}) * so3_exp({0, a.y(), 0}) * so3_exp({a.z(), 0, 0});
    EXPECT_NEAR(angle_between_rad(to_quaternion({a.x(), a.y(), a.z()}), expected), 0.0, 1e-14);
  }
}

TEST(Euler, PositivePitchIsNoseDown) {
  const Eigen::Vector3d nose_in_world =
      to_quaternion({.pitch_rad = 0.1}) * Eigen::Vector3d::UnitX();
  EXPECT_LT(nose_in_world.z(), 0.0);
}

TEST(Euler, RoundTripOfAnglesInPrincipalRange) {
  for (double yaw = -3.1; yaw < 3.14; yaw += 0.31) {
    for (double pitch = -1.57; pitch < 1.571; pitch += 0.314) {
      for (double roll = -3.1; roll < 3.14; roll += 0.31) {
        const EulerAngles recovered = to_euler(to_quaternion({yaw, pitch, roll}));
        // yaw and roll are ill-conditioned for cos(pitch) near 0
        const double tolerance = 1e-14 / std::cos(pitch);
        EXPECT_NEAR(recovered.yaw_rad, yaw, tolerance);
        EXPECT_NEAR(recovered.pitch_rad, pitch, 1e-14);
        EXPECT_NEAR(recovered.roll_rad, roll, tolerance);
      }
    }
  }
}

TEST(Euler, RoundTripOfRandomRotations) {
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Quaterniond q = random_rotation(random);
    EXPECT_NEAR(angle_between_rad(to_quaternion(to_euler(q)), q), 0.0, 1e-14);
    EXPECT_NEAR(angle_between_rad(to_quaternion(to_euler(Eigen::Quaterniond(-q.coeffs()))), q), 0.0,
                1e-14);
  }
}

TEST(Euler, SetsRollToZeroAtGimbalLock) {
  for (const double pitch : {pi / 2, -pi / 2}) {
    const EulerAngles angles{.yaw_rad = 0.7, .pitch_rad = pitch, .roll_rad = 0.4};
    const EulerAngles recovered = to_euler(to_quaternion(angles));
    EXPECT_NEAR(recovered.pitch_rad, pitch, 1e-8);
    EXPECT_EQ(recovered.roll_rad, 0.0);
    // yaw and roll axes: antiparallel nose down, parallel nose up
    EXPECT_NEAR(recovered.yaw_rad, pitch > 0 ? 0.7 - 0.4 : 0.7 + 0.4, 1e-8);
    EXPECT_NEAR(angle_between_rad(to_quaternion(recovered), to_quaternion(angles)), 0.0, 1e-8);
  }
}

TEST(Euler, RatesMatchNumericDerivative) {
  std::mt19937 random(3);
  constexpr double kStep_s = 1e-6;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d a = random_vector(random, 1.2);
    const EulerAngles angles{a.x(), a.y(), a.z()};
    const Eigen::Vector3d rate = random_vector(random, 2.0);
    const Eigen::Quaterniond q = to_quaternion(angles);
    const EulerAngles before = to_euler(q * so3_exp(-kStep_s * rate));
    const EulerAngles after = to_euler(q * so3_exp(kStep_s * rate));
    const Eigen::Vector3d numeric =
        Eigen::Vector3d(after.yaw_rad - before.yaw_rad, after.pitch_rad - before.pitch_rad,
                        after.roll_rad - before.roll_rad) /
        (2 * kStep_s);
    EXPECT_LT((euler_rates(angles, rate) - numeric).norm(), 1e-8);
  }
}

TEST(WrapAngle, MapsToHalfOpenInterval) {
  EXPECT_EQ(wrap_angle_rad(pi), pi);
  EXPECT_EQ(wrap_angle_rad(-pi), pi);
  EXPECT_NEAR(wrap_angle_rad(3 * pi + 0.25), -pi + 0.25, 1e-14);
  EXPECT_NEAR(wrap_angle_rad(-200 * pi - 0.25), -0.25, 1e-12);
  // hold paper's bug: headings on both sides of the cut differ by 0.02 rad, not 2 pi - 0.02
  EXPECT_NEAR(wrap_angle_rad(to_euler(to_quaternion({.yaw_rad = pi - 0.01})).yaw_rad -
                             to_euler(to_quaternion({.yaw_rad = -pi + 0.01})).yaw_rad),
              -0.02, 1e-14);
}

TEST(Tilt, IsIndependentOfYaw) {
  for (const double yaw : {0.0, 1.0, pi, -2.0}) {
    EXPECT_NEAR(tilt_rad(to_quaternion({.yaw_rad = yaw})), 0.0, 1e-15);
    EXPECT_NEAR(tilt_rad(to_quaternion({.yaw_rad = yaw, .pitch_rad = 1e-9})), 1e-9, 1e-15);
    EXPECT_NEAR(tilt_rad(to_quaternion({.yaw_rad = yaw, .roll_rad = -0.5})), 0.5, 1e-15);
    EXPECT_NEAR(tilt_rad(to_quaternion({.yaw_rad = yaw, .roll_rad = pi})), pi, 1e-15);
  }
}

}  // namespace
}  // namespace stillkite
