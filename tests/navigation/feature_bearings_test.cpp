#include "navigation/feature_bearings.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "estimation/two_view/relative_pose_estimator.hpp"
#include "geometry/rigid_transform.hpp"
#include "tests/navigation/small_camera.hpp"

namespace stillkite {
namespace {

constexpr double kFocal_px = 600;

// 300 points two to six metres ahead; every fifth is another one now.
struct Features {
  Eigen::Vector3d way_m = {0.1, -0.05, 0.03};
  bool is_flat = false;
  double told_px = 0.1;
  double noise_px = 0.1;
};

FeatureBearings seen(const Features& features) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.6, 0.6);
  std::uniform_real_distribution<double> depth_m(2, 6);
  std::normal_distribution<double> normal(0, features.noise_px / kFocal_px);
  const Eigen::Quaterniond turn = so3_exp({0.02, -0.03, 0.05});
  FeatureBearings bearings;
  for (std::size_t i = 0; i < 300; ++i) {
    const Eigen::Vector2d reference(place(random), place(random));
    const double depth = features.is_flat ? 4 : depth_m(random);
    const Eigen::Vector3d now = turn * (depth * reference.homogeneous()) + features.way_m;
    Eigen::Vector2d current = now.hnormalized() + Eigen::Vector2d(normal(random), normal(random));
    if (i % 5 == 0) current += Eigen::Vector2d(0.1 + place(random), place(random)) * 0.3;
    bearings.pairs.push_back({reference, current});
    bearings.feature_of_pair.push_back(i);
    const double told = features.told_px / kFocal_px;
    bearings.covariance.emplace_back(told * told * Eigen::Matrix2d::Identity());
  }
  return bearings;
}

double found_in(const FeatureBearings& bearings) {
  return unit_variance(bearings, estimate_relative_pose(bearings.pairs, kFocal_px, {}))
      .value_or(-1);
}

// A lens draws a corner together: a pixel there is more of an angle, and by more along the radius.
TEST(FeatureBearings, CarryTheCovarianceThroughTheLens) {
  const Camera camera = small_camera();
  Eigen::Matrix2f covariance_px2;
  covariance_px2 << 4e-2F, 1e-2F, 1e-2F, 1e-2F;
  const Eigen::Matrix2d L_px = covariance_px2.cast<double>().llt().matrixL();
  for (const Eigen::Vector2d& at_px : {Eigen::Vector2d(200, 120), Eigen::Vector2d(390, 230)}) {
    const FeatureTracks tracks{.reference_px = {at_px.cast<float>()},
                               .current_px = {at_px.cast<float>()},
                               .found = {1},
                               .covariance_px2 = {covariance_px2},
                               .found_count = 1};
    const FeatureBearings bearings = feature_bearings(camera, tracks);
    ASSERT_EQ(bearings.covariance.size(), 1U);
    Eigen::Matrix2d L;
    for (const Eigen::Index i : {0, 1}) {
      L.col(i) =
          0.5 * (*undistort(camera, at_px + L_px.col(i)) - *undistort(camera, at_px - L_px.col(i)));
    }
    const Eigen::Matrix2d expected = L * L.transpose();
    EXPECT_LT((bearings.covariance[0] - expected).norm(), 1e-4 * expected.norm()) << at_px;
  }
}

TEST(UnitVariance, IsOneWhereWhatIsToldIsTrue) {
  EXPECT_NEAR(found_in(seen({})), 1, 0.25);
}

TEST(UnitVariance, TellsByHowMuchMoreFeaturesAreOff) {
  EXPECT_NEAR(found_in(seen({.told_px = 0.1, .noise_px = 0.2})), 4, 1);
  EXPECT_NEAR(found_in(seen({.told_px = 0.2, .noise_px = 0.1})), 0.25, 0.06);
}

// Of features off by 0.1 px half are told to be off by 0.05, and half, as good as not there, by 1.
TEST(UnitVariance, IsThatOfTheFeaturesThatTellMost) {
  FeatureBearings bearings = seen({.told_px = 0.05, .noise_px = 0.1});
  RelativePoseEstimate estimate = estimate_relative_pose(bearings.pairs, kFocal_px, {});
  for (std::size_t i = 0; i < bearings.covariance.size(); i += 2) bearings.covariance[i] *= 400;
  const std::optional<double> found = unit_variance(bearings, estimate);
  for (std::size_t i = 0; i < estimate.inliers.size(); i += 2) estimate.inliers[i] = 0;
  const std::optional<double> of_the_best = unit_variance(bearings, estimate);
  ASSERT_TRUE(found && of_the_best);
  EXPECT_NEAR(*found, *of_the_best, 0.02 * *of_the_best);
}

// Two poses explain a plane, and any way a turn on the spot: the lines are the same.
TEST(UnitVariance, NeedsNoDepth) {
  EXPECT_NEAR(found_in(seen({.is_flat = true})), 1, 0.25);
  EXPECT_NEAR(found_in(seen({.way_m = Eigen::Vector3d::Zero()})), 1, 0.25);
  EXPECT_NEAR(found_in(seen({.way_m = {0.01, 0, 0}})), 1, 0.25);
}

// Its direction is a guess, and the lines with it: never less than true.
TEST(UnitVariance, IsNearlyKnownOfAWayOfAThirdOfAPixel) {
  const double found = found_in(seen({.way_m = {0.002, 0, 0}}));
  EXPECT_GT(found, 0.75);
  EXPECT_LT(found, 1.75);
}

TEST(UnitVariance, IsNotKnownWithoutLinesOrCovariances) {
  FeatureBearings bearings = seen({});
  const RelativePoseEstimate estimate = estimate_relative_pose(bearings.pairs, kFocal_px, {});
  EXPECT_FALSE(unit_variance(bearings, RelativePoseEstimate{.inliers = estimate.inliers}));
  bearings.covariance.clear();
  EXPECT_FALSE(unit_variance(bearings, estimate));
}

}  // namespace
}  // namespace stillkite
