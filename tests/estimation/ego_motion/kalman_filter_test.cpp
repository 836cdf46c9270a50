#include "estimation/ego_motion/kalman_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

constexpr double kVelocityProcess = 0.1 * 0.1;
constexpr double kVelocityNoise = 0.3 * 0.3;
constexpr double kRateProcess = 0.017 * 0.017;
constexpr double kRateNoise = 0.00015 * 0.00015;

TEST(KalmanFilter, CorrectionIsPaperEquationFive) {
  const double P = 0.04;
  const AxisEstimate predicted = predict_axis({2.0, P}, 0.5, 0.04, kVelocityProcess);
  EXPECT_DOUBLE_EQ(predicted.value, 2.0 + 0.5 * 0.04);
  const AxisEstimate corrected = correct_axis(predicted, 3.0, kVelocityNoise);
  const double K = (P + kVelocityProcess) / (P + kVelocityProcess + kVelocityNoise);
  EXPECT_DOUBLE_EQ(corrected.value, K * 3.0 + (1 - K) * (2.0 + 0.5 * 0.04));
  EXPECT_DOUBLE_EQ(corrected.variance, kVelocityNoise * (P + kVelocityProcess) /
                                           (P + kVelocityProcess + kVelocityNoise));
  // the gain minimises the error variance (Joseph form)
  const auto joseph = [&](double k) {
    return (1 - k) * (1 - k) * (P + kVelocityProcess) + k * k * kVelocityNoise;
  };
  EXPECT_NEAR(corrected.variance, joseph(K), 1e-16);
  EXPECT_LT(joseph(K), joseph(K + 1e-3));
  EXPECT_LT(joseph(K), joseph(K - 1e-3));
}

TEST(KalmanFilter, ConvergesToClosedFormSteadyState) {
  const AxisSteadyState velocity = axis_steady_state(kVelocityProcess, kVelocityNoise);
  EXPECT_NEAR(velocity.variance, 0.025414, 5e-7);
  EXPECT_NEAR(velocity.gain, 0.28238, 5e-6);
  EXPECT_NEAR(axis_steady_state(kRateProcess, kRateNoise).gain, 0.99992, 5e-6);

  AxisEstimate axis{0, 100};
  for (int k = 0; k < 200; ++k) {
    axis = correct_axis(predict_axis(axis, 0, 0.04, kVelocityProcess), 1.0, kVelocityNoise);
  }
  EXPECT_NEAR(axis.variance, velocity.variance, 1e-15);
  EXPECT_NEAR(axis.value, 1.0, 1e-12);
}

TEST(KalmanFilter, ErrorDecaysWithSteadyStateGain) {
  const double K = axis_steady_state(kVelocityProcess, kVelocityNoise).gain;
  AxisEstimate axis{1, K * kVelocityNoise};
  for (int k = 1; k <= 20; ++k) {
    axis = correct_axis(predict_axis(axis, 0, 0.04, kVelocityProcess), 0.0, kVelocityNoise);
    EXPECT_NEAR(axis.value, std::pow(1 - K, k), 1e-12);
  }
}

TEST(KalmanFilter, AccelerationInputRemovesLag) {
  const double K = axis_steady_state(kVelocityProcess, kVelocityNoise).gain;
  constexpr double kAcceleration = 2;
  constexpr double kStep_s = 0.04;
  AxisEstimate with_input{0, K * kVelocityNoise};
  AxisEstimate without_input = with_input;
  double truth = 0;
  for (int k = 0; k < 300; ++k) {
    truth += kAcceleration * kStep_s;
    with_input = correct_axis(predict_axis(with_input, kAcceleration, kStep_s, kVelocityProcess),
                              truth, kVelocityNoise);
    without_input = correct_axis(predict_axis(without_input, 0, kStep_s, kVelocityProcess), truth,
                                 kVelocityNoise);
  }
  EXPECT_NEAR(with_input.value, truth, 1e-10);
  EXPECT_NEAR(truth - without_input.value, kAcceleration * kStep_s * (1 - K) / K, 1e-10);
}

TEST(KalmanFilter, CovarianceIsConsistent) {
  constexpr int kSteps = 20000;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  double truth = 0;
  AxisEstimate axis{0, kVelocityNoise};
  double squares = 0;
  for (int k = 0; k < kSteps; ++k) {
    truth += 0.1 * normal(random);
    axis = correct_axis(predict_axis(axis, 0, 0.04, kVelocityProcess), truth + 0.3 * normal(random),
                        kVelocityNoise);
    squares += (axis.value - truth) * (axis.value - truth) / axis.variance;
  }
  // consecutive errors have correlation 1 - K: fewer effective samples in the 99 % band
  const double rho = 1 - axis_steady_state(kVelocityProcess, kVelocityNoise).gain;
  const double effective = kSteps * (1 - rho * rho) / (1 + rho * rho);
  EXPECT_NEAR(squares / kSteps, 1, 2.576 * std::sqrt(2 / effective));
}

TEST(KalmanFilter, UsesFixedOrMeasuredVariance) {
  const AxisMeasurement measured{Vector6d::Ones(), Vector6d::Constant(4.0)};
  AxisEstimates state;
  state.fill({0, 1});
  const AxisEstimates fixed = filter_axes({}, state, measured, Vector6d::Zero(), 0.04);
  EXPECT_DOUBLE_EQ(fixed[1].value,
                   (1 + kVelocityProcess) / (1 + kVelocityProcess + kVelocityNoise));
  EXPECT_DOUBLE_EQ(fixed[5].value, (1 + kRateProcess) / (1 + kRateProcess + kRateNoise));
  const AxisEstimates measured_variance = filter_axes({.variance = MeasurementVariance::measured},
                                                      state, measured, Vector6d::Zero(), 0.04);
  EXPECT_DOUBLE_EQ(measured_variance[1].value, (1 + kVelocityProcess) / (1 + kVelocityProcess + 4));
  EXPECT_DOUBLE_EQ(measured_variance[5].value, (1 + kRateProcess) / (1 + kRateProcess + 4));
}

TEST(KalmanFilter, WithoutMeasurementVarianceGrows) {
  AxisEstimates state;
  state.fill({3, 0.5});
  Vector6d acceleration = Vector6d::Zero();
  acceleration(2) = -10;
  for (int k = 0; k < 5; ++k) state = filter_axes({}, state, {}, acceleration, 0.04);
  EXPECT_DOUBLE_EQ(state[0].value, 3);
  EXPECT_NEAR(state[2].value, 3 - 10 * 5 * 0.04, 1e-12);
  EXPECT_NEAR(state[0].variance, 0.5 + 5 * kVelocityProcess, 1e-12);
  EXPECT_NEAR(state[3].variance, 0.5 + 5 * kRateProcess, 1e-12);
}

TEST(KalmanFilter, TransformsVelocityToWorldAxes) {
  const Eigen::Quaterniond yaw_90_deg = so3_exp({0, 0, std::acos(0.0)});
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << 1, 4, 9, 16, 25, 36;
  const AxisMeasurement m =
      in_filter_axes({Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)}, covariance, yaw_90_deg);
  EXPECT_LT((m.value - Vector6d{-2, 1, 3, 4, 5, 6}).norm(), 1e-12);
  EXPECT_LT((m.variance - Vector6d{4, 1, 9, 16, 25, 36}).norm(), 1e-12);
}

}  // namespace
}  // namespace stillkite
