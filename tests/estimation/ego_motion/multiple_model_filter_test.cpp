#include "estimation/ego_motion/multiple_model_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

namespace stillkite {
namespace {

constexpr double kPeriod_s = 0.04;
constexpr double kPositionSigma_m = 2e-3;
constexpr double kRotationSigma_rad = 1e-3;
constexpr MotionFilterConfig kOneModel{.acceleration_density = 0.2,
                                       .angular_acceleration_density = 0.2};

Matrix6d measurement_covariance(double sigma_m) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(sigma_m * sigma_m);
  covariance.diagonal().tail<3>().setConstant(kRotationSigma_rad * kRotationSigma_rad);
  return covariance;
}

void update(MotionFilter& filter, const RigidTransform& pose, double sigma_m) {
  filter.update(pose, measurement_covariance(sigma_m));
}

void update(MultipleModelFilter& filter, const RigidTransform& pose, double sigma_m) {
  filter.update(pose, measurement_covariance(sigma_m), filter.twist_in_camera(), Matrix6d::Zero());
}

struct Flight {
  double acceleration_density = kOneModel.acceleration_density;
  double acceleration_m_s2 = 0;       // along x, its sign changes every second
  double sigma_m = kPositionSigma_m;  // given standard deviation of the measured positions
  double noise_ratio = 1;             // of the measurements' standard deviation to the given one
  double rotation_step_rad = 0;       // standard deviation from frame to frame, about each axis
};

struct Figures {
  double velocity_rmse_m_s = 0;
  double nees = 0;  // of the mean velocity, 3 degrees of freedom
};

// Camera with random acceleration and poses measured every frame.
template <typename Filter>
Figures simulate(Filter& filter, const Flight& flight) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) -> Eigen::Vector3d {
    return sigma * Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  RigidTransform truth;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  filter.initialize(truth, 1e-3, 1e-3);
  Figures out;
  constexpr int kFrames = 3000;
  constexpr int kConverged = 100;
  for (int k = 0; k < kFrames; ++k) {
    const double sign = k * kPeriod_s - 2 * std::floor(k * kPeriod_s / 2) < 1 ? 1 : -1;
    const Eigen::Vector3d change =
        noise(flight.acceleration_density * std::sqrt(kPeriod_s)) +
        sign * flight.acceleration_m_s2 * kPeriod_s * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d mean_velocity =
        velocity + 0.5 * change + noise(flight.acceleration_density * std::sqrt(kPeriod_s / 12));
    truth.translation += mean_velocity * kPeriod_s;
    truth.rotation = so3_exp(noise(flight.rotation_step_rad)) * truth.rotation;
    velocity += change;
    filter.predict(kPeriod_s);
    update(filter,
           {so3_exp(noise(kRotationSigma_rad)) * truth.rotation,
            truth.translation + noise(flight.noise_ratio * flight.sigma_m)},
           flight.sigma_m);
    if (k < kConverged) continue;
    const Eigen::Vector3d error =
        truth.rotation * filter.mean_twist_in_camera().velocity_m_s - mean_velocity;
    const Matrix6d covariance = filter.mean_twist_covariance();
    out.velocity_rmse_m_s += error.squaredNorm();
    out.nees += error.dot(covariance.topLeftCorner<3, 3>().ldlt().solve(error));
  }
  out.velocity_rmse_m_s = std::sqrt(out.velocity_rmse_m_s / (3 * (kFrames - kConverged)));
  out.nees /= kFrames - kConverged;
  return out;
}

// The flight with one model and with all of them.
std::pair<Figures, Figures> compare(const Flight& flight) {
  MotionFilter one(kOneModel);
  MultipleModelFilter multiple(kOneModel);
  return {simulate(one, flight), simulate(multiple, flight)};
}

TEST(MultipleModelFilter, IsAsAccurateAsTheTrueModel) {
  const auto [reference, figures] = compare({});
  EXPECT_LT(figures.velocity_rmse_m_s, 1.03 * reference.velocity_rmse_m_s);
  EXPECT_NEAR(reference.nees, 3, 0.3);
  EXPECT_NEAR(figures.nees, 3, 0.5);
}

TEST(MultipleModelFilter, FindsNoiseThatTheMeasurementsDoNotReport) {
  const Flight flight{.noise_ratio = 2};
  MotionFilter single(kOneModel);
  MultipleModelFilter multiple(kOneModel);
  const Figures reference = simulate(single, flight);
  const Figures figures = simulate(multiple, flight);
  EXPECT_NEAR(multiple.noise_variance_ratio(), 4, 2);
  EXPECT_GT(reference.nees, 6);
  EXPECT_NEAR(figures.nees, 3, 0.8);
  EXPECT_LT(figures.velocity_rmse_m_s, 0.9 * reference.velocity_rmse_m_s);
}

// Ten times the rotation that the angular acceleration density predicts.
TEST(MultipleModelFilter, RotationIsNoEvidenceOfNoise) {
  MultipleModelFilter filter(kOneModel);
  simulate(filter, {.rotation_step_rad = 0.02});
  EXPECT_LT(filter.noise_variance_ratio(), 2);
}

TEST(MultipleModelFilter, FollowsAnAcceleration) {
  const auto [reference, figures] = compare({.acceleration_m_s2 = 2, .sigma_m = 0.02});
  EXPECT_GT(reference.nees, 12);
  EXPECT_LT(figures.nees, 4);
  EXPECT_LT(figures.velocity_rmse_m_s, reference.velocity_rmse_m_s);
}

TEST(MultipleModelFilter, SteadyFlightLowersTheError) {
  const auto [reference, figures] = compare({.acceleration_density = 0.04});
  EXPECT_LT(figures.velocity_rmse_m_s, 0.8 * reference.velocity_rmse_m_s);
  EXPECT_NEAR(figures.nees, 3, 0.8);
}

// At rest the smallest acceleration density is the likeliest. Images that do not align follow, as
// the camera accelerates.
TEST(MultipleModelFilter, CoastsConsistentlyIntoAnAccelerationFromRest) {
  MultipleModelFilter filter(kOneModel);
  filter.initialize({}, 1, 1);
  for (int k = 0; k < 100; ++k) {
    filter.predict(kPeriod_s);
    update(filter, {}, kPositionSigma_m);
  }
  const double sigma_at_rest_m_s = std::sqrt(filter.twist_covariance()(0, 0));
  EXPECT_LT(sigma_at_rest_m_s, 0.02);
  constexpr int kRejected = 7;
  for (int k = 0; k < kRejected; ++k) {
    filter.predict(kPeriod_s);
    filter.allow_acceleration();
  }
  const double velocity_m_s = 1.5 * kRejected * kPeriod_s;
  EXPECT_LT(velocity_m_s, 3 * std::sqrt(filter.twist_covariance()(0, 0)));
}

TEST(MultipleModelFilter, AllowedAccelerationNeverLowersTheCovariance) {
  MultipleModelFilter filter(kOneModel);
  simulate(filter, {.acceleration_density = 5 * kOneModel.acceleration_density});
  filter.predict(kPeriod_s);
  const double variance = filter.twist_covariance()(0, 0);
  filter.allow_acceleration();
  EXPECT_GE(filter.twist_covariance()(0, 0), 0.999 * variance);
}

TEST(MultipleModelFilter, OriginHasOnePoseInAllModels) {
  MultipleModelFilter filter(kOneModel);
  simulate(filter, {.acceleration_m_s2 = 2});
  const RigidTransform pose = filter.pose();
  const Matrix6d twist_covariance = filter.mean_twist_covariance();
  filter.set_pose_as_origin();
  EXPECT_LT((filter.pose().translation - pose.translation).norm(), 1e-12);
  EXPECT_LT(filter.pose_covariance().norm(), 1e-20);
  EXPECT_LT((filter.mean_twist_covariance() - twist_covariance).norm(),
            1e-9 * twist_covariance.norm());
}

TEST(MultipleModelFilter, DiscontinuityIsLikelierFarFromThePrediction) {
  MultipleModelFilter filter(kOneModel);
  simulate(filter, {});
  filter.predict(kPeriod_s);
  const Eigen::Matrix3d covariance = measurement_covariance(kPositionSigma_m).topLeftCorner<3, 3>();
  const auto log_ratio = [&](double distance_m) {
    const Eigen::Vector3d position = filter.pose().translation + Eigen::Vector3d(distance_m, 0, 0);
    return filter.position_log_likelihood(position, covariance, 1) -
           filter.position_log_likelihood(position, covariance, 0);
  };
  EXPECT_LT(log_ratio(0), -10);
  EXPECT_LT(log_ratio(3 * kPositionSigma_m), 0);
  EXPECT_GT(log_ratio(50 * kPositionSigma_m), 12);
}

// The error of a stamp moves position and rotation together, with a variance far above the others.
TEST(MultipleModelFilter, StaysFiniteWithFullyCorrelatedMeasurements) {
  MultipleModelFilter filter(kOneModel);
  filter.initialize({}, 1, 1);
  const Vector6d common = 1e6 * Vector6d::LinSpaced(6, 0.3, 1.7);
  const Matrix6d covariance = 1e-10 * Matrix6d::Identity() + common * common.transpose();
  for (int i = 0; i < 20; ++i) {
    filter.predict(kPeriod_s);
    filter.update(filter.pose(), covariance, filter.twist_in_camera(), Matrix6d::Zero());
  }
  EXPECT_TRUE(filter.twist_covariance().allFinite());
  EXPECT_TRUE(filter.twist_in_camera().vector().allFinite());
}

}  // namespace
}  // namespace stillkite
