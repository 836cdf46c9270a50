#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "estimation/covariance_intersection.hpp"

namespace stillkite {
namespace {

const Eigen::Matrix3d kVagueX = Eigen::Vector3d(9, 1, 1).asDiagonal();
const Eigen::Matrix3d kVagueZ = Eigen::Vector3d(1, 1, 9).asDiagonal();

// What is said twice is no better known.
TEST(CovarianceIntersection, OfAnEstimateWithItselfIsThatEstimate) {
  const VectorEstimate one{{1, 2, 3}, kVagueX};
  const VectorEstimate both = covariance_intersection(one, one);
  EXPECT_TRUE(both.mean.isApprox(one.mean, 1e-12));
  EXPECT_TRUE(both.covariance.isApprox(one.covariance, 1e-12));
}

TEST(CovarianceIntersection, TakesOfEachWhatItKnowsBest) {
  const VectorEstimate both = covariance_intersection({{0, 0, 0}, kVagueX}, {{1, 0, 1}, kVagueZ});
  EXPECT_NEAR(both.mean.x(), 0.9, 1e-12);
  EXPECT_NEAR(both.mean.z(), 0.1, 1e-12);
  EXPECT_NEAR(both.covariance(0, 0), 1.8, 1e-12);
  EXPECT_NEAR(both.covariance(1, 1), 1, 1e-12);
}

TEST(CovarianceIntersection, HardlyHeedsWhatKnowsNothing) {
  const VectorEstimate known{{1, 2, 3}, kVagueX};
  const VectorEstimate vague{{50, 50, 50}, 1e8 * kVagueZ};
  const VectorEstimate both = covariance_intersection(known, vague);
  EXPECT_TRUE(both.mean.isApprox(known.mean, 1e-4));
  EXPECT_TRUE(both.covariance.isApprox(known.covariance, 1e-4));
}

// Of errors that share nothing, half or all; taken for independent, the last would have 6 of 3.
TEST(CovarianceIntersection, IsNeverTooSure) {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  const auto draw = [&] {
    return Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
  };
  const Eigen::Matrix3d of_a = kVagueX.llt().matrixL();
  const Eigen::Matrix3d of_b = kVagueZ.llt().matrixL();
  for (const double share : {0.0, 0.5, 1.0}) {
    constexpr int kDraws = 20000;
    double nees = 0;
    for (int i = 0; i < kDraws; ++i) {
      const Eigen::Vector3d alike = std::sqrt(share) * draw();
      const double own = std::sqrt(1 - share);
      const VectorEstimate both = covariance_intersection({of_a * (alike + own * draw()), kVagueX},
                                                          {of_b * (alike + own * draw()), kVagueZ});
      nees += both.mean.dot(both.covariance.llt().solve(both.mean)) / kDraws;
    }
    EXPECT_LT(nees, 3.1) << share;
    EXPECT_GT(nees, 1) << share;
  }
}

}  // namespace
}  // namespace stillkite
