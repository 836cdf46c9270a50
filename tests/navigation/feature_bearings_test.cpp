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

// 300 points at 2 to 6 m; every fifth is an outlier.
struct Features {
  Eigen::Vector3d translation_m = {0.1, -0.05, 0.03};
  bool is_flat = false;
  double sigma_px = 0.1;
  double noise_px = 0.1;
};

FeatureBearings make_bearings(const Features& features) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> position(-0.6, 0.6);
  std::uniform_real_distribution<double> depth_m(2, 6);
  std::normal_distribution<double> normal(0, features.noise_px / kFocal_px);
  const Eigen::Quaterniond rotation = so3_exp({0.02, -0.03, 0.05});
  FeatureBearings bearings;
  for (std::size_t i = 0; i < 300; ++i) {
    const Eigen::Vector2d reference(position(random), position(random));
    const double depth = features.is_flat ? 4 : depth_m(random);
    const Eigen::Vector3d current_m =
        rotation * (depth * reference.homogeneous()) + features.translation_m;
    Eigen::Vector2d current =
        current_m.hnormalized() + Eigen::Vector2d(normal(random), normal(random));
    if (i % 5 == 0) current += Eigen::Vector2d(0.1 + position(random), position(random)) * 0.3;
    bearings.pairs.push_back({reference, current});
    bearings.feature_of_pair.push_back(i);
    const double sigma = features.sigma_px / kFocal_px;
    bearings.covariance.emplace_back(sigma * sigma * Eigen::Matrix2d::Identity());
  }
  return bearings;
}

double unit_variance_of(const FeatureBearings& bearings) {
  return unit_variance(bearings, estimate_relative_pose(bearings.pairs, kFocal_px, {}))
      .value_or(-1);
}

// Distortion compresses the corners: a pixel there covers a larger angle, most along the radius.
TEST(FeatureBearings, PropagateCovarianceThroughDistortion) {
  const Camera camera = small_camera();
  Eigen::Matrix2f covariance_px2;
  covariance_px2 << 4e-2F, 1e-2F, 1e-2F, 1e-2F;
  const Eigen::Matrix2d L_px = covariance_px2.cast<double>().llt().matrixL();
  for (const Eigen::Vector2d& position_px :
       {Eigen::Vector2d(200, 120), Eigen::Vector2d(390, 230)}) {
    const FeatureTracks tracks{.reference_px = {position_px.cast<float>()},
                               .current_px = {position_px.cast<float>()},
                               .found = {1},
                               .covariance_px2 = {covariance_px2},
                               .found_count = 1};
    const FeatureBearings bearings = feature_bearings(camera, tracks);
    ASSERT_EQ(bearings.covariance.size(), 1U);
    Eigen::Matrix2d L;
    for (const Eigen::Index i : {0, 1}) {
      L.col(i) = 0.5 * (*undistort(camera, position_px + L_px.col(i)) -
                        *undistort(camera, position_px - L_px.col(i)));
    }
    const Eigen::Matrix2d expected = L * L.transpose();
    EXPECT_LT((bearings.covariance[0] - expected).norm(), 1e-4 * expected.norm()) << position_px;
  }
}

TEST(UnitVariance, IsOneForConsistentCovariance) {
  EXPECT_NEAR(unit_variance_of(make_bearings({})), 1, 0.25);
}

TEST(UnitVariance, IsVarianceRatioOfErrorToCovariance) {
  EXPECT_NEAR(unit_variance_of(make_bearings({.sigma_px = 0.1, .noise_px = 0.2})), 4, 1);
  EXPECT_NEAR(unit_variance_of(make_bearings({.sigma_px = 0.2, .noise_px = 0.1})), 0.25, 0.06);
}

// Error 0.1 px for all features; sigma 0.05 px for one half, 1 px (no information) for the other.
TEST(UnitVariance, IsDominatedByInformativeFeatures) {
  FeatureBearings bearings = make_bearings({.sigma_px = 0.05, .noise_px = 0.1});
  RelativePoseEstimate estimate = estimate_relative_pose(bearings.pairs, kFocal_px, {});
  for (std::size_t i = 0; i < bearings.covariance.size(); i += 2) bearings.covariance[i] *= 400;
  const std::optional<double> variance = unit_variance(bearings, estimate);
  for (std::size_t i = 0; i < estimate.inliers.size(); i += 2) estimate.inliers[i] = 0;
  const std::optional<double> of_informative = unit_variance(bearings, estimate);
  ASSERT_TRUE(variance && of_informative);
  EXPECT_NEAR(*variance, *of_informative, 0.02 * *of_informative);
}

// A plane has two pose solutions, a pure rotation any direction: the epipolar lines are the same.
TEST(UnitVariance, IsIndependentOfDepth) {
  EXPECT_NEAR(unit_variance_of(make_bearings({.is_flat = true})), 1, 0.25);
  EXPECT_NEAR(unit_variance_of(make_bearings({.translation_m = Eigen::Vector3d::Zero()})), 1, 0.25);
  EXPECT_NEAR(unit_variance_of(make_bearings({.translation_m = {0.01, 0, 0}})), 1, 0.25);
}

// The direction, and with it the epipolar lines, is dominated by noise: biased upwards at most.
TEST(UnitVariance, IsBoundedForTranslationOfOneThirdPixel) {
  const double variance = unit_variance_of(make_bearings({.translation_m = {0.002, 0, 0}}));
  EXPECT_GT(variance, 0.75);
  EXPECT_LT(variance, 1.75);
}

TEST(UnitVariance, IsEmptyWithoutDirectionOrCovariances) {
  FeatureBearings bearings = make_bearings({});
  const RelativePoseEstimate estimate = estimate_relative_pose(bearings.pairs, kFocal_px, {});
  EXPECT_FALSE(unit_variance(bearings, RelativePoseEstimate{.inliers = estimate.inliers}));
  bearings.covariance.clear();
  EXPECT_FALSE(unit_variance(bearings, estimate));
}

}  // namespace
}  // namespace stillkite
