#include <gtest/gtest.h>

#include <random>

#include "estimation/sliding_window/imu_factor.hpp"
#include "hand_held_motion.hpp"

namespace stillkite {
namespace {

constexpr ImuNoise kNoNoise{
    .gyro_density = 1e-9, .accel_density = 1e-9, .gyro_bias_walk = 1e-9, .accel_bias_walk = 1e-9};
constexpr ImuNoise kMems{
    .gyro_density = 2e-4, .accel_density = 2e-3, .gyro_bias_walk = 2e-5, .accel_bias_walk = 3e-3};

ImuPreintegration preintegrated(const HandHeldMotion& motion, double from_s, double to_s,
                                const ImuNoise& noise, std::mt19937& random) {
  ImuPreintegration imu(noise);
  imu.reintegrate(motion.gyro_bias_rad_s, motion.accel_bias_m_s2);
  for (const ImuSample& sample : motion.samples(from_s, to_s, noise, random)) imu.add(sample);
  return imu;
}

TEST(ImuPreintegration, PredictsAnalyticMotion) {
  const HandHeldMotion motion;
  std::mt19937 random(1);
  const ImuPreintegration imu = preintegrated(motion, 0.3, 1.3, kNoNoise, random);
  const InertialError error = minus(imu.predict(motion.state(0.3)), motion.state(1.3));
  EXPECT_LT(error.segment<3>(InertialIndex::kRotation).norm(), 1e-5);
  EXPECT_LT(error.segment<3>(InertialIndex::kPosition).norm(), 1e-4);
  EXPECT_LT(error.segment<3>(InertialIndex::kVelocity).norm(), 1e-4);
}

TEST(ImuPreintegration, BiasCorrectionAgreesWithReintegration) {
  const HandHeldMotion motion;
  std::mt19937 random(1);
  ImuPreintegration imu = preintegrated(motion, 0, 0.2, kNoNoise, random);
  const Eigen::Vector3d gyro_bias = motion.gyro_bias_rad_s + Eigen::Vector3d(2e-3, -1e-3, 3e-3);
  const Eigen::Vector3d accel_bias = motion.accel_bias_m_s2 + Eigen::Vector3d(0.02, 0.01, -0.03);
  const ImuPreintegration::Motion corrected = imu.motion(gyro_bias, accel_bias);
  imu.reintegrate(gyro_bias, accel_bias);
  const ImuPreintegration::Motion exact = imu.motion(gyro_bias, accel_bias);
  EXPECT_LT(angle_between_rad(corrected.rotation, exact.rotation), 1e-6);
  EXPECT_LT((corrected.velocity - exact.velocity).norm(), 1e-5);
  EXPECT_LT((corrected.position - exact.position).norm(), 1e-6);
}

TEST(ImuPreintegration, AppendedIntervalsAgreeWithOne) {
  const HandHeldMotion motion;
  std::mt19937 random(1);
  ImuPreintegration first = preintegrated(motion, 0, 0.1, kMems, random);
  const ImuPreintegration second = preintegrated(motion, 0.1, 0.2, kMems, random);
  const InertialState in_two = second.predict(first.predict(motion.state(0)));
  first.append(second);
  EXPECT_DOUBLE_EQ(first.duration_s(), 0.2);
  EXPECT_LT(minus(first.predict(motion.state(0)), in_two).norm(), 1e-9);
}

// Normalized error squared of 300 noisy integrations; expectation 9.
TEST(ImuPreintegration, CovarianceIsConsistent) {
  const HandHeldMotion motion;
  std::mt19937 random(7);
  constexpr int kTrials = 300;
  double sum = 0;
  for (int i = 0; i < kTrials; ++i) {
    const ImuPreintegration imu = preintegrated(motion, 0.2, 0.5, kMems, random);
    sum += imu_squared_error(imu, motion.state(0.2), motion.state(0.5));
  }
  EXPECT_NEAR(sum / kTrials, 9, 1.3);
}

TEST(ImuPreintegration, GapLeavesMotionUnknown) {
  const HandHeldMotion motion;
  std::mt19937 random(1);
  ImuPreintegration imu(kMems);
  imu.reintegrate(motion.gyro_bias_rad_s, motion.accel_bias_m_s2);
  ImuSample held = motion.samples(0, 0.005, kMems, random).front();
  held.dt_s = 0.45;
  held.is_gap = true;
  imu.add(held);
  EXPECT_LT(imu_squared_error(imu, motion.state(0), motion.state(0.45)), 20);
}

TEST(ImuFactor, ResidualIsZeroAtTheTruth) {
  const HandHeldMotion motion;
  std::mt19937 random(1);
  const ImuPreintegration imu = preintegrated(motion, 0, 0.1, kMems, random);
  const InertialState start = motion.state(0);
  EXPECT_LT(imu_squared_error(imu, start, imu.predict(start)), 1e-12);
}

TEST(ImuFactor, JacobiansAgreeWithDifferences) {
  const HandHeldMotion motion;
  std::mt19937 random(1);
  const ImuPreintegration imu = preintegrated(motion, 0, 0.1, kMems, random);
  const InertialState start = plus(motion.state(0), 1e-3 * InertialError::LinSpaced(15, -1, 1));
  const InertialState end = motion.state(0.1);
  const ImuResidual at = imu_residual(imu, start, end, start, end);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < InertialIndex::kSize; ++i) {
    const InertialError step = kStep * InertialError::Unit(i);
    const auto difference = [&](const auto& moved) {
      return ((moved(step).residual - moved(-step).residual) / (2 * kStep)).eval();
    };
    const auto by_start = difference(
        [&](const InertialError& e) { return imu_residual(imu, plus(start, e), end, start, end); });
    const auto by_end = difference(
        [&](const InertialError& e) { return imu_residual(imu, start, plus(end, e), start, end); });
    EXPECT_LT((at.by_start.col(i) - by_start).norm(), 1e-4 * (1 + by_start.norm())) << i;
    EXPECT_LT((at.by_end.col(i) - by_end).norm(), 1e-4 * (1 + by_end.norm())) << i;
  }
}

// Position and yaw are the gauge: the residual does not depend on them.
TEST(ImuFactor, ResidualIsInvariantToPositionAndYaw) {
  const HandHeldMotion motion;
  std::mt19937 random(3);
  const ImuPreintegration imu = preintegrated(motion, 0, 0.1, kMems, random);
  const RigidTransform moved{so3_exp({0, 0, 0.7}), {3, -2, 5}};
  const auto transformed = [&](InertialState state) {
    state.world_from_imu = moved * state.world_from_imu;
    state.velocity_in_world_m_s = moved.rotation * state.velocity_in_world_m_s;
    return state;
  };
  const InertialState start = motion.state(0);
  const InertialState end = motion.state(0.1);
  EXPECT_NEAR(imu_squared_error(imu, transformed(start), transformed(end)),
              imu_squared_error(imu, start, end), 1e-6);
}

}  // namespace
}  // namespace stillkite
