#include "estimation/ego_motion/integration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"

namespace stillkite {
namespace {

using Eigen::Vector3d;

// Level coordinated turn: constant bank and heading rate, speed along body x.
struct CoordinatedTurn {
  double bank_rad = 25 * kDegree;
  double heading_rate_rad_s = 0.3;
  double speed_m_s = 12;

  [[nodiscard]] RigidTransform pose(double t_s) const {
    const double heading = heading_rate_rad_s * t_s;
    const double radius_m = speed_m_s / heading_rate_rad_s;
    return {to_quaternion({.yaw_rad = heading, .roll_rad = bank_rad}),
            {radius_m * std::sin(heading), radius_m * (1 - std::cos(heading)), 50}};
  }
  [[nodiscard]] Vector3d rate_in_body() const {
    return heading_rate_rad_s * Vector3d(0, std::sin(bank_rad), std::cos(bank_rad));
  }
};

double euler_error_in_turn(int steps) {
  const CoordinatedTurn turn;
  constexpr double kDuration_s = 20;
  const double dt = kDuration_s / steps;
  RigidTransform pose = turn.pose(0);
  for (int k = 0; k < steps; ++k) {
    const Vector3d velocity = turn.pose(k * dt).rotation * Vector3d(turn.speed_m_s, 0, 0);
    pose = integrate_euler(pose, velocity, turn.rate_in_body(), Vector6d::Zero(), dt);
  }
  EXPECT_LT(angle_between_rad(pose.rotation, turn.pose(kDuration_s).rotation), 1e-9);
  return (pose.translation - turn.pose(kDuration_s).translation).norm();
}

// Tumbling body: rate varies within a step.
Vector3d tumbling_rate(double t_s) {
  return {0.5 * std::cos(1.1 * t_s), 0.4 * std::sin(0.7 * t_s), 0.6};
}

Eigen::Quaterniond tumbled(double duration_s, int steps) {
  RigidTransform pose;
  const double dt = duration_s / steps;
  for (int k = 0; k < steps; ++k) {
    pose = integrate_twist(pose, {Vector3d::Zero(), tumbling_rate((k + 0.5) * dt)}, dt);
  }
  return pose.rotation;
}

TEST(Integration, IsExactForConstantVelocity) {
  const Vector3d velocity(3, -2, 0.5);
  RigidTransform euler{to_quaternion({.yaw_rad = 1, .pitch_rad = 0.2, .roll_rad = -0.1}),
                       {1, 2, 30}};
  RigidTransform exact = euler;
  const Vector3d initial = euler.translation;
  for (int k = 0; k < 250; ++k) {
    euler = integrate_euler(euler, velocity, Vector3d::Zero(), Vector6d::Zero(), 0.04);
    exact = integrate_twist(exact, {exact.rotation.conjugate() * velocity, Vector3d::Zero()}, 0.04);
  }
  EXPECT_LT((euler.translation - (initial + 10 * velocity)).norm(), 1e-10);
  EXPECT_LT((exact.translation - (initial + 10 * velocity)).norm(), 1e-10);
}

TEST(Integration, EulerIsExactForConstantAcceleration) {
  Vector6d a;
  a << 0.5, 0, -0.2, 0, 0, 0.1;
  Vector3d velocity(1, 0, 0);
  Vector3d rate(0, 0, 0.2);
  RigidTransform pose{Eigen::Quaterniond::Identity(), {0, 0, 20}};
  constexpr double kStep_s = 0.1;
  for (int k = 0; k < 50; ++k) {
    pose = integrate_euler(pose, velocity, rate, a, kStep_s);
    velocity += a.head<3>() * kStep_s;
    rate += a.tail<3>() * kStep_s;
  }
  EXPECT_LT((pose.translation - Vector3d(5 + 0.25 * 25, 0, 20 - 0.1 * 25)).norm(), 1e-10);
  EXPECT_NEAR(to_euler(pose.rotation).yaw_rad, 0.2 * 5 + 0.05 * 25, 1e-10);
}

TEST(Integration, TwistIsExactInCoordinatedTurn) {
  const CoordinatedTurn turn;
  RigidTransform pose = turn.pose(0);
  for (int k = 0; k < 8; ++k) {  // 43 deg per step
    pose = integrate_twist(pose, {Vector3d(turn.speed_m_s, 0, 0), turn.rate_in_body()}, 2.5);
  }
  EXPECT_LT((pose.translation - turn.pose(20).translation).norm(), 1e-9);
  EXPECT_LT(angle_between_rad(pose.rotation, turn.pose(20).rotation), 1e-9);
}

TEST(Integration, EulerIsFirstOrderInCoordinatedTurn) {
  const double coarse = euler_error_in_turn(500);
  const double fine = euler_error_in_turn(1000);
  EXPECT_NEAR(coarse / fine, 2, 0.02);
  EXPECT_LT(coarse, 0.3);
}

TEST(Integration, TwistIsSecondOrderForTumbling) {
  const Eigen::Quaterniond truth = tumbled(5, 64000);
  const double coarse = angle_between_rad(tumbled(5, 100), truth);
  const double fine = angle_between_rad(tumbled(5, 200), truth);
  EXPECT_NEAR(coarse / fine, 4, 0.1);
}

TEST(Integration, YawIsContinuousAcrossPi) {
  for (const double rate : {0.9, -0.9}) {
    RigidTransform euler{to_quaternion({.yaw_rad = rate > 0 ? 2.9 : -2.9, .pitch_rad = 0.1}),
                         Vector3d::Zero()};
    RigidTransform exact = euler;
    const Vector3d rate_in_body = euler.rotation.conjugate() * Vector3d(0, 0, rate);
    for (int k = 0; k < 200; ++k) {
      const RigidTransform before = euler;
      euler = integrate_euler(euler, Vector3d::Zero(), rate_in_body, Vector6d::Zero(), 0.01);
      exact = integrate_twist(exact, {Vector3d::Zero(), rate_in_body}, 0.01);
      EXPECT_NEAR(angle_between_rad(before.rotation, euler.rotation), 0.009, 1e-9);
    }
    const double expected = wrap_angle_rad((rate > 0 ? 2.9 : -2.9) + 2 * rate);
    EXPECT_NEAR(to_euler(euler.rotation).yaw_rad, expected, 1e-9);
    EXPECT_NEAR(to_euler(exact.rotation).yaw_rad, expected, 1e-9);
  }
}

TEST(Integration, EulerConvertsBodyRatesToAngleRates) {
  const EulerAngles initial{.yaw_rad = 0.3, .pitch_rad = 14 * kDegree, .roll_rad = 14.4 * kDegree};
  ASSERT_NEAR(tilt_rad(to_quaternion(initial)), 20 * kDegree, 0.1 * kDegree);
  const Vector3d rate(0.02, -0.03, 0.25);
  constexpr double kDuration_s = 4;
  const Eigen::Quaterniond truth = to_quaternion(initial) * so3_exp(rate * kDuration_s);

  const auto error_of = [&](int steps) {
    RigidTransform pose{to_quaternion(initial), Vector3d::Zero()};
    for (int k = 0; k < steps; ++k) {
      pose = integrate_euler(pose, Vector3d::Zero(), rate, Vector6d::Zero(), kDuration_s / steps);
    }
    return angle_between_rad(pose.rotation, truth);
  };
  const double error = error_of(100);  // 25 frames/s
  EXPECT_LT(error, 0.3 * kDegree);
  EXPECT_NEAR(error / error_of(200), 2, 0.05);

  const Eigen::Quaterniond with_equal_rates =
      to_quaternion({.yaw_rad = initial.yaw_rad + rate.z() * kDuration_s,
                     .pitch_rad = initial.pitch_rad + rate.y() * kDuration_s,
                     .roll_rad = initial.roll_rad + rate.x() * kDuration_s});
  EXPECT_GT(angle_between_rad(with_equal_rates, truth), 10 * kDegree);
}

}  // namespace
}  // namespace stillkite
