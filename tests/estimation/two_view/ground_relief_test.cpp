#include "estimation/two_view/ground_relief.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace stillkite {
namespace {

constexpr double kCameraHeight_m = 3;
constexpr double kSideways_m = 0.6;
constexpr double kNoise = 1e-3;
const Eigen::Vector3d kStraightDown(0, 0, 1);
const RigidTransform kSideways{Eigen::Quaterniond::Identity(), {kSideways_m, 0, 0}};

// Row of features across the image; depths over height cycle through `depths`.
std::vector<BearingPair> row_of_features(const std::vector<double>& depths,
                                         const RigidTransform& current_from_reference) {
  std::vector<BearingPair> pairs;
  for (std::size_t i = 0; i < 60; ++i) {
    const Eigen::Vector3d a(-0.6 + 0.02 * static_cast<double>(i), 0, 1);
    const double depth_m = kCameraHeight_m * depths[i % depths.size()];
    pairs.push_back({a.hnormalized(), (current_from_reference * (depth_m * a)).hnormalized()});
  }
  return pairs;
}

std::optional<double> relief_of(const std::vector<BearingPair>& pairs, const RigidTransform& motion,
                                const Eigen::Vector3d& normal) {
  return ground_relief(pairs, std::vector<unsigned char>(pairs.size(), 1),
                       {motion.rotation, motion.translation.normalized()}, normal, kNoise);
}

TEST(GroundRelief, FlatGroundHasZeroRelief) {
  const auto pairs = row_of_features({1}, kSideways);
  EXPECT_NEAR(relief_of(pairs, kSideways, kStraightDown).value(), 0, 1e-12);
}

// Tilted camera: n.a and the depth change over the image.
TEST(GroundRelief, AccountsForTiltedCamera) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.5, 0.3, 1).normalized();
  const RigidTransform motion{Eigen::Quaterniond(Eigen::AngleAxisd(0.1, kStraightDown)),
                              {0.3, -0.4, 0.2}};
  std::vector<BearingPair> pairs;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d a(-0.6 + 0.02 * i, 0.01 * (i % 7), 1);
    const Eigen::Vector3d X = kCameraHeight_m / normal.dot(a) * a;
    pairs.push_back({a.hnormalized(), (motion * X).hnormalized()});
  }
  EXPECT_NEAR(relief_of(pairs, motion, normal).value(), 0, 1e-9);
  EXPECT_NEAR(ground_misfit(pairs, motion, normal, kCameraHeight_m, kNoise).value(), 0, 1e-9);
  EXPECT_GT(relief_of(pairs, motion, kStraightDown).value(), 0.05);
}

// Parallaxes 1, 3/2 and 2 relative to flat ground: the median 3/2 is taken as ground, the median
// residual is 1/2.
TEST(GroundRelief, IsRelativeParallaxResidualOfFlatGround) {
  const auto pairs = row_of_features({1, 2 / 3.0, 0.5}, kSideways);
  EXPECT_NEAR(relief_of(pairs, kSideways, kStraightDown).value(), 1 / 3.0, 1e-9);
}

TEST(GroundRelief, FeaturesAboveTheHorizonHaveFullRelief) {
  const auto pairs = row_of_features({1}, kSideways);
  EXPECT_NEAR(relief_of(pairs, kSideways, -kStraightDown).value(), 1, 1e-9);
}

TEST(GroundRelief, ReturnsNothingBelowMinimumParallax) {
  const RigidTransform small_motion{Eigen::Quaterniond::Identity(), {0.01, 0, 0}};
  const auto pairs = row_of_features({1}, small_motion);
  EXPECT_FALSE(relief_of(pairs, small_motion, kStraightDown));
  EXPECT_FALSE(ground_misfit(pairs, small_motion, kStraightDown, kCameraHeight_m, kNoise));
  EXPECT_FALSE(relief_of({}, kSideways, kStraightDown));
}

TEST(GroundMisfit, IsRelativeTranslationError) {
  const auto pairs = row_of_features({1}, kSideways);
  EXPECT_NEAR(ground_misfit(pairs, kSideways, kStraightDown, kCameraHeight_m, kNoise).value(), 0,
              1e-12);
  const RigidTransform half{kSideways.rotation, 0.5 * kSideways.translation};
  EXPECT_NEAR(ground_misfit(pairs, half, kStraightDown, kCameraHeight_m, kNoise).value(), 0.5,
              1e-9);
}

}  // namespace
}  // namespace stillkite
