#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "estimation/ego_motion/motion_filter.hpp"

// Steady state of a constant-velocity filter: positions of variance R every T seconds, white
// acceleration of density q, tracking index lambda^2 = q T^3 / R. With s^2 = 1 - alpha and
// beta = lambda s the Riccati equation is the palindromic polynomial
//
//     s^4 - lambda s^3 + (lambda^2 / 6 - 2) s^2 - lambda s + 1 = 0,
//
// quadratic in s + 1/s (Kalata's alpha-beta filter with continuous-time white acceleration).

namespace stillkite {
namespace {

struct Gains {
  double alpha;  // position gain
  double beta;   // velocity gain: K = beta / T
};

Gains closed_form(double lambda) {
  const double sum = 0.5 * (lambda + std::sqrt(lambda * lambda / 3 + 16));  // s + 1/s
  const double s = 0.5 * (sum - std::sqrt(sum * sum - 4));
  return {1 - s * s, lambda * s};
}

constexpr double kFramePeriod_s = 0.04;
constexpr MotionFilterConfig kConfig{.acceleration_density = 0.5,
                                     .angular_acceleration_density = 0.2};

// Filter in steady state: static camera, exact measurements with the given sigmas.
MotionFilter steady_state_filter(double position_sigma_m, double angle_sigma_rad) {
  MotionFilter filter(kConfig);
  const RigidTransform pose{so3_exp({0.4, -1.0, 0.3}), {1, 2, 3}};
  filter.initialize(pose, 5, 1);
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(position_sigma_m * position_sigma_m);
  covariance.diagonal().tail<3>().setConstant(angle_sigma_rad * angle_sigma_rad);
  for (int k = 0; k < 5000; ++k) {
    filter.predict(kFramePeriod_s);
    filter.update(pose, covariance);
  }
  return filter;
}

void expect_closed_form(double position_variance, double velocity_variance, double sigma,
                        double density) {
  const double R = sigma * sigma;
  const double q = density * density;
  const Gains gains =
      closed_form(std::sqrt(q * kFramePeriod_s * kFramePeriod_s * kFramePeriod_s / R));
  EXPECT_NEAR(position_variance / (gains.alpha * R), 1, 1e-9);
  const double expected =
      R * gains.alpha * gains.beta / (kFramePeriod_s * kFramePeriod_s * (1 - gains.alpha)) -
      0.5 * q * kFramePeriod_s;
  EXPECT_NEAR(velocity_variance / expected, 1, 1e-9);
}

TEST(MotionFilterGain, ConvergesToClosedFormForAnyTrackingIndex) {
  for (const double sigma : {1e-4, 1e-3, 1e-2, 0.1}) {
    const MotionFilter filter = steady_state_filter(sigma, sigma);
    for (int axis = 0; axis < 3; ++axis) {
      expect_closed_form(filter.pose_covariance()(axis, axis),
                         filter.twist_covariance()(axis, axis), sigma,
                         kConfig.acceleration_density);
      expect_closed_form(filter.pose_covariance()(axis + 3, axis + 3),
                         filter.twist_covariance()(axis + 3, axis + 3), sigma,
                         kConfig.angular_acceleration_density);
    }
  }
}

TEST(MotionFilterGain, ClosedFormMatchesContinuousDoubleIntegrator) {
  // Kalman-Bucy, measurement noise of density r = R T: gains sqrt(2) w and w^2, w^4 = q / r
  constexpr double kShortStep_s = 1e-5;
  constexpr double kNoiseDensity = 0.04;
  constexpr double kAccelerationDensity = 0.25;
  const double w = std::pow(kAccelerationDensity / kNoiseDensity, 0.25);
  const double R = kNoiseDensity / kShortStep_s;
  const Gains gains = closed_form(std::sqrt(kAccelerationDensity * std::pow(kShortStep_s, 3) / R));
  EXPECT_NEAR(gains.alpha / kShortStep_s, std::sqrt(2.0) * w, 1e-4);
  EXPECT_NEAR(gains.beta / (kShortStep_s * kShortStep_s), w * w, 1e-4);
}

// NEES of the mean twist of a camera driven by the filter's process model, integrated exactly per
// axis. The measured poses depend on the assumed twist; the filter models that if `modelled`.
double mean_twist_nees(const Matrix6d& pose_by_twist, bool modelled) {
  constexpr double kSigma_m = 2e-3;
  constexpr double kSigma_rad = 1e-3;
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(kSigma_m * kSigma_m);
  covariance.diagonal().tail<3>().setConstant(kSigma_rad * kSigma_rad);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) -> Eigen::Vector3d {
    return sigma * Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  double nees = 0;
  int count = 0;
  MotionFilter filter(kConfig);
  RigidTransform truth;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  filter.initialize(truth, 1e-3, 1e-3);
  for (int k = 0; k < 3000; ++k) {
    // velocity and position noise of white acceleration have correlation sqrt(3) / 2
    const auto process_noise = [&](double density) {
      const Eigen::Vector3d velocity_part = noise(density * std::sqrt(kFramePeriod_s));
      const Eigen::Vector3d position_part = noise(density * std::sqrt(kFramePeriod_s / 12));
      return std::pair{velocity_part,
                       Eigen::Vector3d(kFramePeriod_s * (0.5 * velocity_part + position_part))};
    };
    const auto [velocity_noise, displacement_noise] = process_noise(kConfig.acceleration_density);
    const auto [rate_noise, rotation_noise] = process_noise(kConfig.angular_acceleration_density);
    const Eigen::Vector3d displacement = velocity * kFramePeriod_s + displacement_noise;
    const Eigen::Vector3d rotation_vector = rate * kFramePeriod_s + rotation_noise;
    const Eigen::Quaterniond world_from_middle = truth.rotation * so3_exp(0.5 * rotation_vector);
    truth = {truth.rotation * so3_exp(rotation_vector), truth.translation + displacement};
    velocity += velocity_noise;
    rate += rate_noise;

    filter.predict(kFramePeriod_s);
    const Twist assumed = filter.twist_in_camera();
    const Vector6d pose_error =
        pose_by_twist *
        (assumed.vector() - Twist{truth.rotation.conjugate() * velocity, rate}.vector());
    const Eigen::Vector3d rotation_error = noise(kSigma_rad) + pose_error.tail<3>();
    filter.update({so3_exp(rotation_error) * truth.rotation,
                   truth.translation + noise(kSigma_m) + pose_error.head<3>()},
                  covariance, assumed, modelled ? pose_by_twist : Matrix6d::Zero());
    Vector6d error = filter.mean_twist_in_camera().vector();
    error.head<3>() -= world_from_middle.conjugate() * displacement / kFramePeriod_s;
    error.tail<3>() -= rotation_vector / kFramePeriod_s;
    if (k < 50) continue;
    nees += error.dot(filter.mean_twist_covariance().ldlt().solve(error));
    ++count;
  }
  return nees / count;
}

TEST(MotionFilterMeanTwist, CovarianceIsConsistent) {
  EXPECT_NEAR(mean_twist_nees(Matrix6d::Zero(), true), 6, 0.5);
}

// Rolling shutter: velocity and angular rate are correlated.
TEST(MotionFilterMeanTwist, CovarianceIsConsistentForTwistDependentPose) {
  Matrix6d pose_by_twist = 0.3 * kFramePeriod_s * Matrix6d::Identity();
  pose_by_twist(0, 4) = pose_by_twist(4, 0) = -kFramePeriod_s;
  EXPECT_NEAR(mean_twist_nees(pose_by_twist, true), 6, 0.5);
  EXPECT_GT(mean_twist_nees(pose_by_twist, false), 30);
}

TEST(MotionFilterMeanTwist, CovarianceIsInvariantToOriginAndWorldRotation) {
  MotionFilter filter(kConfig);
  filter.initialize({so3_exp({0.4, -1.0, 0.3}), {1, 2, 3}}, 5, 1);
  filter.predict(kFramePeriod_s);
  filter.update(filter.pose(), 1e-4 * Matrix6d::Identity());
  filter.predict(kFramePeriod_s);
  const Matrix6d before = filter.mean_twist_covariance();
  filter.set_pose_as_origin();
  filter.transform_world({so3_exp({1, 2, -0.5}), {4, 5, 6}});
  EXPECT_LT((filter.mean_twist_covariance() - before).norm(), 1e-9 * before.norm());
  EXPECT_EQ(filter.pose_covariance().norm(), 0);
}

TEST(MotionFilterMeanTwist, WithoutIntervalIsCurrentTwist) {
  MotionFilter filter(kConfig);
  filter.initialize({so3_exp({0.4, -1.0, 0.3}), {100, 2, 3}}, 5, 1);
  for (const double dt_s : {0.0, 7e-18}) {
    if (dt_s > 0) filter.predict(dt_s);
    EXPECT_EQ(filter.mean_twist_in_camera().vector(), filter.twist_in_camera().vector());
    EXPECT_EQ(filter.mean_twist_covariance(), filter.twist_covariance());
  }
}

}  // namespace
}  // namespace stillkite
