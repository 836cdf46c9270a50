#include "estimation/two_view/five_point.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/polynomial_roots.hpp"
#include "tests/estimation/two_view/two_view_scene.hpp"

namespace stillkite {
namespace {

// Up to sign.
double distance(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return std::min((a - b).norm(), (a + b).norm());
}

TEST(FivePoint, the_true_matrix_is_among_the_solutions) {
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

TEST(FivePoint, every_solution_is_an_essential_matrix_of_the_pairs) {
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

TEST(FivePoint, one_pair_five_times_gives_finite_matrices_or_none) {
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

TEST(PolynomialRoots, finds_ten_roots_of_different_sizes) {
  const std::vector<double> roots{-40, -7, -1, -0.3, -0.02, 0.01, 0.5, 1, 3, 20};
  const RealRoots found = real_roots(with_roots(roots));
  ASSERT_EQ(found.count, 10);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(found.root[i], roots[i], 1e-9 * (1 + std::abs(roots[i])));
  }
}

TEST(PolynomialRoots, leaves_out_complex_ones) {
  Polynomial p = with_roots({-2, 0.5, 4});
  for (std::size_t i = p.size() - 1; i > 1; --i) p[i] += p[i - 2];  // times (1 + z^2)
  const RealRoots found = real_roots(p);
  ASSERT_EQ(found.count, 3);
  EXPECT_NEAR(found.root[0], -2, 1e-12);
  EXPECT_NEAR(found.root[2], 4, 1e-12);
}

TEST(PolynomialRoots, a_repeated_root_counts_once) {
  const RealRoots found = real_roots(with_roots({-1, 2, 2, 5}));
  ASSERT_EQ(found.count, 3);
  EXPECT_NEAR(found.root[1], 2, 1e-6);
}

TEST(PolynomialRoots, has_none_without_a_polynomial) {
  EXPECT_EQ(real_roots({}).count, 0);
  EXPECT_EQ(real_roots({1}).count, 0);
  EXPECT_EQ(real_roots({std::nan(""), 1}).count, 0);
}

}  // namespace
}  // namespace stillkite
