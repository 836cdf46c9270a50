#include "geometry/chi_square.hpp"

#include <gtest/gtest.h>

#include <cmath>

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

TEST(ChiSquare, ConstantsAreQuantiles) {
  EXPECT_NEAR(kChiSquareMedian1, chi_square_quantile(0.5, 1), 5e-5);
  EXPECT_NEAR(kChiSquareMedian2, chi_square_quantile(0.5, 2), 1e-11);
  EXPECT_EQ(kChiSquareFiveSigma3, std::floor(chi_square_quantile(1 - 3e-7, 3)));
  EXPECT_EQ(kChiSquareFiveSigma5, std::floor(chi_square_quantile(1 - 3e-7, 5)));
}

}  // namespace
}  // namespace stillkite
