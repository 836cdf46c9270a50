#include "evaluation/alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillkite {
namespace {

/// Climbing helix, estimated in another world frame.
std::vector<PosePair> pairs_with(const Similarity& truth_from_estimate) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 40; ++i) {
    const double s = 0.1 * i;
    const RigidTransform estimate{.rotation = so3_exp({0.1 * s, -0.2, s}),
                                  .translation = {3 * std::cos(s), 2 * std::sin(s), 5 + 0.3 * s}};
    pairs.push_back({.index = static_cast<std::size_t>(i),
                     .stamp = from_seconds(s),
                     .estimate = estimate,
                     .truth = apply(truth_from_estimate, estimate)});
  }
  return pairs;
}

void expect_recovered(Alignment alignment, const Similarity& expected) {
  const auto pairs = pairs_with(expected);
  const auto found = best_alignment(pairs, alignment);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, expected.scale, 1e-12);
  EXPECT_NEAR(angle_between_rad(found->rigid.rotation, expected.rigid.rotation), 0, 1e-7);
  EXPECT_NEAR((found->rigid.translation - expected.rigid.translation).norm(), 0, 1e-12);
  for (const PosePair& pair : aligned(pairs, *found)) {
    EXPECT_NEAR((pair.estimate.translation - pair.truth.translation).norm(), 0, 1e-12);
    EXPECT_NEAR(angle_between_rad(pair.estimate.rotation, pair.truth.rotation), 0, 1e-7);
  }
}

TEST(BestAlignment, NoneIsIdentity) {
  const auto found = best_alignment(pairs_with({.rigid = {.translation = {1, 2, 3}}}), {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->scale, 1);
  EXPECT_EQ(found->rigid.translation, Eigen::Vector3d::Zero());
}

TEST(BestAlignment, OriginRecoversRigidMotion) {
  expect_recovered(Alignment::origin, {.rigid = {so3_exp({0.3, -0.5, 2.0}), {4, -5, 6}}});
}

TEST(BestAlignment, YawRecoversRotationAboutVertical) {
  expect_recovered(Alignment::yaw, {.rigid = {so3_exp({0, 0, 2.9}), {4, -5, 6}}});
}

TEST(BestAlignment, YawAlignmentHasNoTilt) {
  const auto found =
      best_alignment(pairs_with({.rigid = {so3_exp({0.2, 0.1, 1.0}), {0, 0, 0}}}), Alignment::yaw);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->rigid.rotation.x(), 0);
  EXPECT_EQ(found->rigid.rotation.y(), 0);
}

TEST(BestAlignment, Se3RecoversRigidMotion) {
  expect_recovered(Alignment::se3, {.rigid = {so3_exp({0.3, -0.5, 2.0}), {4, -5, 6}}});
}

TEST(BestAlignment, Sim3RecoversSimilarity) {
  expect_recovered(Alignment::sim3,
                   {.scale = 2.5, .rigid = {so3_exp({0.3, -0.5, 2.0}), {4, -5, 6}}});
}

// Coplanar points fit a rotation and a reflection equally well; only the rotation is a motion.
TEST(BestAlignment, Se3OfCoplanarPositionsIsARotation) {
  auto pairs = pairs_with({.rigid = {so3_exp({0, 0, 1}), {0, 0, 0}}});
  for (PosePair& pair : pairs) pair.estimate.translation.z() = pair.truth.translation.z() = 0;
  const auto found = best_alignment(pairs, Alignment::se3);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->rigid.rotation.toRotationMatrix().determinant(), 1, 1e-12);
  EXPECT_NEAR(angle_between_rad(found->rigid.rotation, so3_exp({0, 0, 1})), 0, 1e-7);
}

TEST(BestAlignment, ReturnsNothingForUnderdeterminedPositions) {
  std::vector<PosePair> line;
  std::vector<PosePair> climb;
  for (int i = 0; i < 10; ++i) {
    line.push_back({.estimate = {.translation = {1.0 * i, 0.0, 0.0}},
                    .truth = {.translation = {0.0, 1.0 * i, 0.0}}});
    climb.push_back({.estimate = {.translation = {0.0, 0.0, 1.0 * i}},
                     .truth = {.translation = {0.0, 0.0, 1.0 * i}}});
  }
  EXPECT_FALSE(best_alignment(line, Alignment::se3));
  EXPECT_FALSE(best_alignment(line, Alignment::sim3));
  EXPECT_TRUE(best_alignment(line, Alignment::yaw));
  EXPECT_FALSE(best_alignment(climb, Alignment::yaw));
  EXPECT_FALSE(best_alignment({}, Alignment::origin));
}

// Means of constant positions have rounding errors, which are no extent.
TEST(BestAlignment, ReturnsNothingForConstantPositions) {
  auto pairs = pairs_with({.rigid = {so3_exp({0, 0, 1}), {0, 0, 0}}});
  auto still_truth = pairs;
  for (PosePair& pair : pairs) pair.estimate.translation = {0.1, 0.2, 20.3};
  for (PosePair& pair : still_truth) pair.truth.translation = {0.1, 0.2, 20.3};
  for (const Alignment alignment : {Alignment::yaw, Alignment::se3, Alignment::sim3}) {
    EXPECT_FALSE(best_alignment(pairs, alignment));
    EXPECT_FALSE(best_alignment(still_truth, alignment));
  }
}

}  // namespace
}  // namespace stillkite
