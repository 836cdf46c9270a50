#include "estimation/two_view/five_point.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/polynomial_roots.hpp"
#include "tests/estimation/two_view/two_view_scene.hpp"

namespace stillkite {
namespace {

// Distance up to sign.
double distance(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return std::min((a - b).norm(), (a + b).norm());
}

TEST(FivePoint, SolutionsContainTheTrueMatrix) {
  for (std::uint32_t seed = 1; seed <= 300; ++seed) {
    const TwoViews views =
        make_two_views({.points = 5, .baseline = 0.5, .relief = 1, .noise_px = 0}, seed);
    const EssentialCandidates found =
        solve_five_point(std::span<const BearingPair, 5>(views.pairs.data(), 5));
    double nearest = 1;
    for (int k = 0; k < found.count; ++k) {
      nearest = std::min(nearest, distance(found.essential[static_cast<std::size_t>(k)],
                                           essential_matrix(views.truth)));
    }
    EXPECT_LT(nearest, 1e-9) << seed;
  }
}

TEST(FivePoint, EverySolutionSatisfiesTheConstraints) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    const TwoViews views =
        make_two_views({.points = 5, .baseline = 0.5, .relief = 1, .noise_px = 3}, seed);
    const EssentialCandidates found =
        solve_five_point(std::span<const BearingPair, 5>(views.pairs.data(), 5));
    for (int k = 0; k < found.count; ++k) {
      const Eigen::Matrix3d& E = found.essential[static_cast<std::size_t>(k)];
      const Eigen::Matrix3d S = E * E.transpose();
      EXPECT_LT((2 * S * E - S.trace() * E).norm(), 1e-9) << seed;
      for (const BearingPair& pair : views.pairs) {
        EXPECT_LT(std::abs(pair.current.homogeneous().dot(E * pair.reference.homogeneous())),
                  1e-12);
      }
    }
  }
}

TEST(FivePoint, RepeatedPairGivesFiniteMatricesOrNone) {
  const std::array<BearingPair, 5> same{};
  const EssentialCandidates found = solve_five_point(same);
  for (int k = 0; k < found.count; ++k) {
    EXPECT_TRUE(found.essential[static_cast<std::size_t>(k)].allFinite());
  }
}

Polynomial with_roots(const std::vector<double>& roots) {
  Polynomial p{1};
  for (const double root : roots) {
    for (std::size_t i = p.size() - 1; i > 0; --i) p[i] = p[i - 1] - root * p[i];
    p[0] *= -root;
  }
  return p;
}

TEST(PolynomialRoots, FindsTenRootsOfDifferentMagnitudes) {
  const std::vector<double> roots{-40, -7, -1, -0.3, -0.02, 0.01, 0.5, 1, 3, 20};
  const RealRoots found = real_roots(with_roots(roots));
  ASSERT_EQ(found.count, 10);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(found.root[i], roots[i], 1e-9 * (1 + std::abs(roots[i])));
  }
}

TEST(PolynomialRoots, IgnoresComplexRoots) {
  Polynomial p = with_roots({-2, 0.5, 4});
  for (std::size_t i = p.size() - 1; i > 1; --i) p[i] += p[i - 2];  // times (1 + z^2)
  const RealRoots found = real_roots(p);
  ASSERT_EQ(found.count, 3);
  EXPECT_NEAR(found.root[0], -2, 1e-12);
  EXPECT_NEAR(found.root[2], 4, 1e-12);
}

TEST(PolynomialRoots, CountsRepeatedRootOnce) {
  const RealRoots found = real_roots(with_roots({-1, 2, 2, 5}));
  ASSERT_EQ(found.count, 3);
  EXPECT_NEAR(found.root[1], 2, 1e-6);
}

TEST(PolynomialRoots, ConstantOrNonFinitePolynomialHasNoRoots) {
  EXPECT_EQ(real_roots({}).count, 0);
  EXPECT_EQ(real_roots({1}).count, 0);
  EXPECT_EQ(real_roots({std::nan(""), 1}).count, 0);
}

}  // namespace
}  // namespace stillkite
