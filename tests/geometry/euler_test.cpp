#include "geometry/euler.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/rigid_transform.hpp"
#include "tests/geometry/random_values.hpp"

namespace stillkite {
namespace {

using std::numbers::pi;

TEST(Euler, is_yaw_then_pitch_then_roll) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d a = random_vector(random, 3.0);
    const Eigen::Quaterniond expected =
        so3_exp({0, 0, a.x()}) * so3_exp({0, a.y(), 0}) * so3_exp({a.z(), 0, 0});
    EXPECT_NEAR(angle_between_rad(to_quaternion({a.x(), a.y(), a.z()}), expected), 0.0, 1e-14);
  }
}

TEST(Euler, positive_pitch_is_nose_down) {
  const Eigen::Vector3d nose_in_world =
      to_quaternion({.pitch_rad = 0.1}) * Eigen::Vector3d::UnitX();
  EXPECT_LT(nose_in_world.z(), 0.0);
}

TEST(Euler, round_trip_on_angles_within_the_principal_range) {
  for (double yaw = -3.1; yaw < 3.14; yaw += 0.31) {
    for (double pitch = -1.57; pitch < 1.571; pitch += 0.314) {
      for (double roll = -3.1; roll < 3.14; roll += 0.31) {
        const EulerAngles back = to_euler(to_quaternion({yaw, pitch, roll}));
        // yaw and roll lose digits as the cosine of the pitch vanishes
        const double tolerance = 1e-14 / std::cos(pitch);
        EXPECT_NEAR(back.yaw_rad, yaw, tolerance);
        EXPECT_NEAR(back.pitch_rad, pitch, 1e-14);
        EXPECT_NEAR(back.roll_rad, roll, tolerance);
      }
    }
  }
}

TEST(Euler, round_trip_on_rotations_everywhere) {
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Quaterniond q = random_rotation(random);
    EXPECT_NEAR(angle_between_rad(to_quaternion(to_euler(q)), q), 0.0, 1e-14);
    EXPECT_NEAR(angle_between_rad(to_quaternion(to_euler(Eigen::Quaterniond(-q.coeffs()))), q), 0.0,
                1e-14);
  }
}

TEST(Euler, at_gimbal_lock_roll_is_zero_and_yaw_takes_all) {
  for (const double pitch : {pi / 2, -pi / 2}) {
    const EulerAngles angles{.yaw_rad = 0.7, .pitch_rad = pitch, .roll_rad = 0.4};
    const EulerAngles back = to_euler(to_quaternion(angles));
    EXPECT_NEAR(back.pitch_rad, pitch, 1e-8);
    EXPECT_EQ(back.roll_rad, 0.0);
    // nose down the axes of yaw and roll oppose each other, nose up they agree
    EXPECT_NEAR(back.yaw_rad, pitch > 0 ? 0.7 - 0.4 : 0.7 + 0.4, 1e-8);
    EXPECT_NEAR(angle_between_rad(to_quaternion(back), to_quaternion(angles)), 0.0, 1e-8);
  }
}

TEST(Euler, rates_are_the_derivative_of_the_angles) {
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

TEST(WrapAngle, is_in_the_half_open_turn) {
  EXPECT_EQ(wrap_angle_rad(pi), pi);
  EXPECT_EQ(wrap_angle_rad(-pi), pi);
  EXPECT_NEAR(wrap_angle_rad(3 * pi + 0.25), -pi + 0.25, 1e-14);
  EXPECT_NEAR(wrap_angle_rad(-200 * pi - 0.25), -0.25, 1e-12);
  // the hold paper's bug: two headings either side of the cut are two degrees apart, not 358
  EXPECT_NEAR(wrap_angle_rad(to_euler(to_quaternion({.yaw_rad = pi - 0.01})).yaw_rad -
                             to_euler(to_quaternion({.yaw_rad = -pi + 0.01})).yaw_rad),
              -0.02, 1e-14);
}

TEST(Tilt, is_the_angle_off_the_vertical_whatever_the_heading) {
  for (const double yaw : {0.0, 1.0, pi, -2.0}) {
    EXPECT_NEAR(tilt_rad(to_quaternion({.yaw_rad = yaw})), 0.0, 1e-15);
    EXPECT_NEAR(tilt_rad(to_quaternion({.yaw_rad = yaw, .pitch_rad = 1e-9})), 1e-9, 1e-15);
    EXPECT_NEAR(tilt_rad(to_quaternion({.yaw_rad = yaw, .roll_rad = -0.5})), 0.5, 1e-15);
    EXPECT_NEAR(tilt_rad(to_quaternion({.yaw_rad = yaw, .roll_rad = pi})), pi, 1e-15);
  }
}

}  // namespace
}  // namespace stillkite
