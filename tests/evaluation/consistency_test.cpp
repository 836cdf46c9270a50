#include "evaluation/consistency.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>
#include <vector>

namespace stillkite {
namespace {

TEST(Nees, IsThreeForOneSigmaAlongEveryAxis) {
  const Eigen::Matrix3d P = Eigen::Vector3d(4, 9, 16).asDiagonal();
  EXPECT_NEAR(*nees({2, 3, -4}, P), 3, 1e-12);
  EXPECT_FALSE(nees({2, 3, -4}, Eigen::Matrix3d::Zero()));
}

// Two degrees of freedom: quantile = -2 ln(1 - probability).
TEST(Consistency, CountsSharesBeyondThreeAndFiveSigma) {
  const double three_sigma = -2 * std::log(std::erfc(3 / std::sqrt(2)));
  const double five_sigma = -2 * std::log(std::erfc(5 / std::sqrt(2)));
  const std::vector<double> samples{1, three_sigma - 1e-6, three_sigma + 1e-6, five_sigma - 1e-6,
                                    five_sigma + 1e-6};
  const auto result = consistency(samples, 2);
  ASSERT_TRUE(result);
  EXPECT_DOUBLE_EQ(result->share_beyond_3_sigma, 0.6);
  EXPECT_DOUBLE_EQ(result->share_beyond_5_sigma, 0.2);
  EXPECT_FALSE(consistency({samples.data(), 1}, 2)) << "one frame is no statistic";
}

// Covariance 4 I: sigma sqrt(12); error norms 3 and 4: RMS sqrt(12.5).
TEST(NormalizedErrors, ComparesMedianSigmaWithRmsError) {
  NormalizedErrors errors;
  const Eigen::Matrix3d P = 4 * Eigen::Matrix3d::Identity();
  errors.add({3, 0, 0}, P);
  errors.add({0, 0, 4}, P);
  errors.add({100, 0, 0}, Eigen::Matrix3d::Zero());
  const auto result = errors.consistency();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->samples, 2);
  EXPECT_NEAR(result->mean, 0.5 * (9.0 / 4 + 16.0 / 4), 1e-12);
  EXPECT_NEAR(*result->sigma_over_rms, std::sqrt(12 / 12.5), 1e-12);
}

TEST(Consistency, AcceptsConsistentAndRejectsOptimisticCovariance) {
  Eigen::Matrix3d P;
  P << 4, 1, 0, 1, 3, -1, 0, -1, 2;
  const Eigen::Matrix3d L = P.llt().matrixL();
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<double> consistent;
  std::vector<double> optimistic;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d z(normal(random), normal(random), normal(random));
    consistent.push_back(*nees(L * z, P));
    optimistic.push_back(*nees(1.2 * (L * z), P));
  }
  const auto result = consistency(consistent, 3);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->samples, 2000);
  EXPECT_GT(result->mean, result->mean_low);
  EXPECT_LT(result->mean, result->mean_high);
  EXPECT_NEAR(result->share_inside, 0.95, 0.015);
  EXPECT_GT(consistency(optimistic, 3)->mean, result->mean_high);
  EXPECT_FALSE(consistency({}, 3));
}

}  // namespace
}  // namespace stillkite
