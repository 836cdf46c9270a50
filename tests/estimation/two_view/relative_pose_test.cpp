#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/opencv_relative_pose.hpp"
#include "estimation/two_view/relative_pose_estimator.hpp"
#include "estimation/two_view/sampson_refinement.hpp"
#include "tests/estimation/two_view/two_view_scene.hpp"

namespace stillkite {
namespace {

TEST(RelativePose, ExactPairsGiveExactPose) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const TwoViews views = make_two_views({.points = 200, .relief = 0.5, .noise_px = 0}, seed);
    const RelativePoseEstimate found = estimate_relative_pose(views.pairs, kFocal_px, {});
    ASSERT_EQ(found.model, ViewModel::general) << seed;
    EXPECT_LT(rotation_error_deg(found.pose, views.truth), 1e-7) << seed;
    EXPECT_LT(direction_error_deg(found.pose, views.truth), 1e-6) << seed;
  }
}

TEST(RelativePose, OpenCvFindsPoseOfExactPairs) {
  for (const auto& [method, name] : EnumNames<EssentialMethod>::value) {
    const TwoViews views = make_two_views({.points = 200, .relief = 0.5, .noise_px = 0}, 3);
    const RelativePoseEstimate found =
        estimate_relative_pose_opencv(views.pairs, kFocal_px, {.essential_method = method});
    ASSERT_EQ(found.model, ViewModel::general) << name;
    EXPECT_LT(rotation_error_deg(found.pose, views.truth), 1e-2) << name;
    EXPECT_LT(direction_error_deg(found.pose, views.truth), 1e-1) << name;
    EXPECT_GT(found.inlier_count, 190);
  }
}

TEST(RelativePose, IsRobustToSixtyPercentOutliers) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const TwoViews views = make_two_views({.outliers = 0.6}, seed);
    const RelativePoseEstimate found = estimate_relative_pose(views.pairs, kFocal_px, {});
    ASSERT_EQ(found.model, ViewModel::general) << seed;
    EXPECT_LT(rotation_error_deg(found.pose, views.truth), 0.15) << seed;
    EXPECT_LT(direction_error_deg(found.pose, views.truth), 1.5) << seed;
    EXPECT_NEAR(found.residual * kFocal_px, 0.3, 0.05);
    const RelativePoseEstimate again = estimate_relative_pose(views.pairs, kFocal_px, {});
    EXPECT_EQ(found.pose.direction, again.pose.direction);
  }
}

TEST(RelativePose, TooFewOrDegeneratePairsAreUndecided) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::vector<BearingPair>> degenerate{
      {},
      std::vector<BearingPair>(4, BearingPair{{0.1, 0.2}, {0.3, 0.1}}),
      std::vector<BearingPair>(50, BearingPair{{nan, 0}, {0, 0}}),
      make_two_views({.points = 100, .outliers = 1}, 1).pairs};
  for (const auto& pairs : degenerate) {
    const RelativePoseEstimate found = estimate_relative_pose(pairs, kFocal_px, {});
    EXPECT_EQ(found.model, ViewModel::undecided);
    EXPECT_EQ(found.inliers.size(), pairs.size());
    EXPECT_TRUE(found.pose.current_from_reference.coeffs().allFinite());
    EXPECT_TRUE(found.pose.direction.allFinite());
    EXPECT_TRUE(found.covariance.allFinite());
    const RelativePoseEstimate by_opencv = estimate_relative_pose_opencv(pairs, kFocal_px, {});
    EXPECT_EQ(by_opencv.inliers.size(), pairs.size());
    EXPECT_TRUE(by_opencv.pose.direction.allFinite());
  }
}

}  // namespace
}  // namespace stillkite
