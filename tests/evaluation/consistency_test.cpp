#include "evaluation/consistency.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>
#include <vector>

#include "evaluation/chi_square.hpp"

namespace stillkite {
namespace {

TEST(ChiSquare, TwoDegreesOfFreedomIsExponential) {
  for (const double x : {0.01, 0.5, 2.0, 9.0, 40.0}) {
    EXPECT_NEAR(chi_square_cdf(x, 2), 1 - std::exp(-x / 2), 1e-13);
  }
  EXPECT_NEAR(chi_square_quantile(0.95, 2), -2 * std::log(0.05), 1e-9);
}

TEST(ChiSquare, OneDegreeOfFreedomIsTheErrorFunction) {
  for (const double x : {0.01, 0.5, 2.0, 9.0, 40.0}) {
    EXPECT_NEAR(chi_square_cdf(x, 1), std::erf(std::sqrt(x / 2)), 1e-13);
  }
  EXPECT_EQ(chi_square_cdf(0, 1), 0);
}

// Tables of the chi-square distribution (Abramowitz & Stegun, table 26.8).
TEST(ChiSquare, QuantilesMatchTables) {
  EXPECT_NEAR(chi_square_quantile(0.95, 3), 7.81473, 1e-5);
  EXPECT_NEAR(chi_square_quantile(0.95, 6), 12.5916, 1e-4);
  EXPECT_NEAR(chi_square_quantile(0.025, 100), 74.2219, 1e-4);
  EXPECT_NEAR(chi_square_quantile(0.975, 100), 129.561, 1e-3);
}

// Central limit: mean k, variance 2k.
TEST(ChiSquare, ManyDegreesOfFreedomApproachNormal) {
  const double k = 30000;
  EXPECT_NEAR(chi_square_quantile(0.975, k), k + 1.959964 * std::sqrt(2 * k), 3);
}

TEST(Nees, IsThreeForOneSigmaAlongEveryAxis) {
  const Eigen::Matrix3d P = Eigen::Vector3d(4, 9, 16).asDiagonal();
  EXPECT_NEAR(*nees({2, 3, -4}, P), 3, 1e-12);
  EXPECT_FALSE(nees({2, 3, -4}, Eigen::Matrix3d::Zero()));
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
