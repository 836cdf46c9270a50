#include "navigation/landmark_selection.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

// Noise variance of one feature with sigma 0.001 on z = 1.
double noise_variance(int landmarks, double unit_variance, const Eigen::Vector2d& at = {0.1, 0.2}) {
  FusionConfig config;
  config.landmarks = landmarks;
  LandmarkSelection selection(config, 500);
  for (int i = 0; i < 1000; ++i) selection.add_unit_variance(unit_variance);
  const FeatureBearings bearings{.pairs = {{.reference = at, .current = at}},
                                 .feature_of_pair = {0},
                                 .covariance = {1e-6 * Eigen::Matrix2d::Identity()}};
  return selection.views(bearings, {1}).front().covariance(0, 0);
}

// The unit variance of one false pose applies to its frame only; an empty one changes nothing.
TEST(LandmarkSelection, OutlierFrameHasItsOwnUnitVariance) {
  LandmarkSelection selection({}, 500);
  for (int i = 0; i < 1000; ++i) selection.add_unit_variance(1);
  selection.add_unit_variance(300);
  EXPECT_EQ(selection.unit_variance(), 300);
  selection.add_unit_variance({});
  EXPECT_NEAR(selection.unit_variance(), 1.1, 0.02);
  selection.add_unit_variance(2);
  EXPECT_NEAR(selection.unit_variance(), 1.1, 0.02);
}

// Calibration errors are correlated between neighbours and do not average out.
TEST(LandmarkSelection, CalibrationErrorIsNotAveragedByMoreLandmarks) {
  EXPECT_DOUBLE_EQ(noise_variance(96, 2), noise_variance(48, 2));
  const double ratio = noise_variance(48, 12) / noise_variance(48, 2);
  EXPECT_NEAR(ratio, 6, 0.3);
  EXPECT_GT(noise_variance(96, 12), 1.5 * noise_variance(48, 12));
  EXPECT_LE(noise_variance(96, 12), 2 * noise_variance(48, 12));
}

TEST(LandmarkSelection, CalibrationErrorGrowsOutwards) {
  const Eigen::Vector2d centre(0, 0), edge(1, 0.5);
  EXPECT_DOUBLE_EQ(noise_variance(96, 10, edge), noise_variance(96, 10, centre)) << "coding";
  EXPECT_GT(noise_variance(96, 30, edge), 10 * noise_variance(96, 30, centre));
}

}  // namespace
}  // namespace stillkite
