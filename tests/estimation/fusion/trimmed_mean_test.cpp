#include "estimation/fusion/trimmed_mean.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <random>
#include <vector>

namespace stillkite {
namespace {

// The mean of what is left where a share of normal errors is left out, until nothing changes.
Eigen::Vector2d trimmed_mean(std::vector<Eigen::Vector2d> errors, std::size_t left) {
  constexpr int kMost = 50;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int i = 0; i < kMost; ++i) {
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(left),
                     errors.end(), [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
                       return (a - mean).squaredNorm() < (b - mean).squaredNorm();
                     });
    Eigen::Vector2d next = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < left; ++k) next += errors[k] / static_cast<double>(left);
    if (next == mean) break;
    mean = next;
  }
  return mean;
}

TEST(TrimmedMean, IsKnownByAsMuchLessAsItsErrorsSay) {
  constexpr std::size_t kErrors = 1000;
  constexpr int kTrials = 1500;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (const double share : {0.05, 0.1, 0.2}) {
    const auto left = static_cast<std::size_t>(kErrors * (1 - share));
    double squared = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<Eigen::Vector2d> errors;
      for (std::size_t i = 0; i < kErrors; ++i) errors.emplace_back(normal(random), normal(random));
      squared += trimmed_mean(std::move(errors), left).squaredNorm() / (2 * kTrials);
    }
    EXPECT_NEAR(squared * static_cast<double>(left), trimmed_mean_growth(share), 0.12) << share;
  }
}

TEST(TrimmedMean, OfAllIsTheMean) {
  EXPECT_EQ(trimmed_mean_growth(0), 1);
}

}  // namespace
}  // namespace stillkite
