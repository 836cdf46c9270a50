#include "estimation/two_view/sampson_refinement.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <numeric>

#include "estimation/two_view/relative_pose_estimator.hpp"
#include "estimation/two_view/transfer_error.hpp"
#include "tests/estimation/two_view/two_view_scene.hpp"

namespace stillkite {
namespace {

BearingColumns columns_of(const std::vector<BearingPair>& pairs) {
  std::vector<int> order(pairs.size());
  std::iota(order.begin(), order.end(), 0);
  return {pairs, order};
}

TEST(SampsonRefinement, EssentialJacobianMatchesNumericDerivative) {
  const RelativePose pose = make_two_views({.points = 1}, 4).truth;
  const Eigen::Matrix<double, 9, 5> J = essential_jacobian(pose);
  for (int k = 0; k < 5; ++k) {
    const double h = 1e-6;
    const Eigen::Matrix3d dE = (essential_matrix(apply(pose, h * PoseStep::Unit(k))) -
                                essential_matrix(apply(pose, -h * PoseStep::Unit(k)))) /
                               (2 * h);
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(J(i, k), dE(i / 3, i % 3), 1e-9) << k;
  }
}

// One pair and a large cutoff: the sums are g g^T and e g.
TEST(SampsonRefinement, GradientMatchesNumericDerivative) {
  const TwoViews views = make_two_views({.points = 1, .noise_px = 20}, 5);
  const Eigen::Matrix3d E = essential_matrix(views.truth);
  const SampsonSums sums = sampson_sums(columns_of(views.pairs), E, 1e6);
  for (int i = 0; i < 9; ++i) {
    const double h = 1e-6;
    Eigen::Matrix3d plus = E, minus = E;
    plus(i / 3, i % 3) += h;
    minus(i / 3, i % 3) -= h;
    const double slope = (std::pow(sampson_error(plus, views.pairs[0]), 2) -
                          std::pow(sampson_error(minus, views.pairs[0]), 2)) /
                         (4 * h);
    EXPECT_NEAR(sums.gradient[i], slope, 1e-8) << i;
    EXPECT_NEAR(sums.normal(i, i), std::pow(slope / sampson_error(E, views.pairs[0]), 2), 1e-6);
  }
}

TEST(SampsonRefinement, TransferGradientMatchesNumericDerivative) {
  const TwoViews views = make_two_views({.points = 1, .noise_px = 3}, 5);
  const Eigen::Matrix3d H = views.truth.current_from_reference.toRotationMatrix();
  const TransferSums sums = transfer_sums(columns_of(views.pairs), H, 1e6);
  const double error = transfer_error(H, views.pairs[0]);
  EXPECT_NEAR(transfer_distances(columns_of(views.pairs), H)[0], error, 1e-6);
  for (int i = 0; i < 9; ++i) {
    const double h = 1e-6;
    Eigen::Matrix3d plus = H, minus = H;
    plus(i / 3, i % 3) += h;
    minus(i / 3, i % 3) -= h;
    const double slope = (std::pow(transfer_error(plus, views.pairs[0]), 2) -
                          std::pow(transfer_error(minus, views.pairs[0]), 2)) /
                         (4 * h);
    // neglects the derivative of the weight matrix, second order in the error
    EXPECT_NEAR(sums.gradient[i], slope, 3 * error * error) << i;
  }
}

TEST(SampsonRefinement, ConvergesToExactPose) {
  const TwoViews views = make_two_views({.points = 100, .relief = 0.5, .noise_px = 0}, 6);
  PoseStep initial_error;
  initial_error << 0.01, -0.02, 0.01, 0.1, -0.1;
  const RelativePose found =
      refine_pose(columns_of(views.pairs), apply(views.truth, initial_error), 100 / kFocal_px, 30);
  EXPECT_LT(rotation_error_deg(found, views.truth), 1e-7);
  EXPECT_LT(direction_error_deg(found, views.truth), 1e-6);
}

// NEES of the rotation vector and of the direction in its tangent plane.
struct Nees {
  double rotation = 0, direction = 0;
};
Nees nees_of(const RelativePoseEstimate& found, const RelativePose& truth) {
  const Eigen::Vector3d w =
      so3_log(found.pose.current_from_reference * truth.current_from_reference.conjugate());
  const Eigen::Matrix<double, 3, 2> basis = tangent_basis(found.pose.direction);
  const Eigen::Vector2d u = basis.transpose() * (found.pose.direction - truth.direction);
  const Eigen::Matrix2d direction_covariance =
      basis.transpose() * found.covariance.bottomRightCorner<3, 3>() * basis;
  const Eigen::Matrix3d rotation_covariance_block = found.covariance.topLeftCorner<3, 3>();
  return {w.dot(rotation_covariance_block.ldlt().solve(w)),
          u.dot(direction_covariance.ldlt().solve(u))};
}

class Covariance : public testing::TestWithParam<TwoViewScene> {};

// Mean of 120 chi-square samples with k degrees of freedom: standard deviation sqrt(2 k / 120),
// 0.22 for 3 and 0.18 for 2; tolerance four standard deviations.
TEST_P(Covariance, IsConsistentWithErrors) {
  constexpr int kSeeds = 120;
  Nees mean;
  int counted = 0;
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const TwoViews views = make_two_views(GetParam(), seed);
    const RelativePoseEstimate found = estimate_relative_pose(
        views.pairs, kFocal_px, {},
        {.prior = views.truth,
         .up_in_reference = views.normal,
         .up_in_current = views.truth.current_from_reference * views.normal});
    if (found.model != GetParam().content) continue;
    const Nees nees = nees_of(found, views.truth);
    mean.rotation += nees.rotation;
    mean.direction += nees.direction;
    ++counted;
  }
  ASSERT_GT(counted, 110);
  EXPECT_NEAR(mean.rotation / counted, 3, 0.9);
  EXPECT_NEAR(mean.direction / counted, 2, 0.72);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, Covariance,
    testing::Values(TwoViewScene{.points = 300, .relief = 0.4},
                    TwoViewScene{.points = 300, .relief = 0.4, .outliers = 0.3},
                    TwoViewScene{.content = ViewModel::plane, .points = 300, .outliers = 0.2},
                    TwoViewScene{.points = 1000, .relief = 0.4, .patch_px = 0.3},
                    TwoViewScene{.content = ViewModel::plane, .points = 1000, .patch_px = 0.3}));

}  // namespace
}  // namespace stillkite
