#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "estimation/covariance_intersection.hpp"

namespace stillkite {
namespace {

const Eigen::Matrix3d kLargeCovarianceX = Eigen::Vector3d(9, 1, 1).asDiagonal();
const Eigen::Matrix3d kLargeCovarianceZ = Eigen::Vector3d(1, 1, 9).asDiagonal();

// Duplicated information does not reduce the covariance.
TEST(CovarianceIntersection, FusionWithItselfIsIdentity) {
  const VectorEstimate one{{1, 2, 3}, kLargeCovarianceX};
  const VectorEstimate both = covariance_intersection(one, one);
  EXPECT_TRUE(both.mean.isApprox(one.mean, 1e-12));
  EXPECT_TRUE(both.covariance.isApprox(one.covariance, 1e-12));
}

TEST(CovarianceIntersection, WeighsEachAxisByItsCovariance) {
  const VectorEstimate both =
      covariance_intersection({{0, 0, 0}, kLargeCovarianceX}, {{1, 0, 1}, kLargeCovarianceZ});
  EXPECT_NEAR(both.mean.x(), 0.9, 1e-12);
  EXPECT_NEAR(both.mean.z(), 0.1, 1e-12);
  EXPECT_NEAR(both.covariance(0, 0), 1.8, 1e-12);
  EXPECT_NEAR(both.covariance(1, 1), 1, 1e-12);
}

TEST(CovarianceIntersection, IgnoresUninformativeEstimate) {
  const VectorEstimate informative{{1, 2, 3}, kLargeCovarianceX};
  const VectorEstimate uninformative{{50, 50, 50}, 1e8 * kLargeCovarianceZ};
  const VectorEstimate both = covariance_intersection(informative, uninformative);
  EXPECT_TRUE(both.mean.isApprox(informative.mean, 1e-4));
  EXPECT_TRUE(both.covariance.isApprox(informative.covariance, 1e-4));
}

// Error correlation 0, 0.5 and 1. Fusion as independent estimates would give NEES 6 instead of 3
// for the last.
TEST(CovarianceIntersection, IsConsistentForAnyCorrelation) {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  const auto draw = [&] {
    return Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
  };
  const Eigen::Matrix3d sqrt_a = kLargeCovarianceX.llt().matrixL();
  const Eigen::Matrix3d sqrt_b = kLargeCovarianceZ.llt().matrixL();
  for (const double correlation : {0.0, 0.5, 1.0}) {
    constexpr int kDraws = 20000;
    double nees = 0;
    for (int i = 0; i < kDraws; ++i) {
      const Eigen::Vector3d common = std::sqrt(correlation) * draw();
      const double independent = std::sqrt(1 - correlation);
      const VectorEstimate both =
          covariance_intersection({sqrt_a * (common + independent * draw()), kLargeCovarianceX},
                                  {sqrt_b * (common + independent * draw()), kLargeCovarianceZ});
      nees += both.mean.dot(both.covariance.llt().solve(both.mean)) / kDraws;
    }
    EXPECT_LT(nees, 3.1) << correlation;
    EXPECT_GT(nees, 1) << correlation;
  }
}

}  // namespace
}  // namespace stillkite
