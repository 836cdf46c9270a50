#include "geometry/chi_square.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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

// One degree of freedom: sigmas^2. Two: -2 ln of the normal variable's two-sided tail. Three:
// tail(x) = erfc(sqrt(x/2)) + sqrt(2 x / pi) exp(-x/2).
TEST(ChiSquare, SigmasHaveTheTailOfANormalVariable) {
  for (const double sigmas : {0.1, 1.0, 3.0, 5.0, 20.0}) {
    const double tail = std::erfc(sigmas / std::numbers::sqrt2);
    EXPECT_NEAR(chi_square_at_sigmas(sigmas, 1), sigmas * sigmas, 1e-9 * sigmas * sigmas);
    EXPECT_NEAR(chi_square_at_sigmas(sigmas, 2), -2 * std::log(tail), 1e-9 * sigmas * sigmas);
    const double x = chi_square_at_sigmas(sigmas, 3);
    const double tail_of_x =
        std::erfc(std::sqrt(x / 2)) + std::sqrt(2 * x / std::numbers::pi) * std::exp(-x / 2);
    EXPECT_NEAR(tail_of_x / tail, 1, 1e-8);
  }
  EXPECT_NEAR(chi_square_at_sigmas(3, 3), 14.1564, 1e-4);
}

TEST(ChiSquare, SigmasBeyondDoublePrecisionAreBounded) {
  EXPECT_GT(chi_square_at_sigmas(100, 3), 1300);
  EXPECT_LT(chi_square_at_sigmas(100, 3), 1600);
}

TEST(ChiSquare, ConstantsAreQuantiles) {
  EXPECT_NEAR(kChiSquareMedian1, chi_square_quantile(0.5, 1), 5e-5);
  EXPECT_NEAR(kChiSquareMedian2, chi_square_quantile(0.5, 2), 1e-11);
  EXPECT_EQ(kChiSquareFiveSigma3, std::floor(chi_square_quantile(1 - 3e-7, 3)));
  EXPECT_EQ(kChiSquareFiveSigma5, std::floor(chi_square_quantile(1 - 3e-7, 5)));
}

}  // namespace
}  // namespace stillkite
