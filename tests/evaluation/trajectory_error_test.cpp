#include "evaluation/trajectory_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/vector_error.hpp"

namespace stillkite {
namespace {

/// Straight flight of 100 m, one pair per metre, constant tilted attitude.
std::vector<PosePair> straight_pairs() {
  std::vector<PosePair> pairs;
  for (int i = 0; i <= 100; ++i) {
    const RigidTransform pose{so3_exp({0.1, -0.2, 0.4}), {1.0 * i, 0, 10}};
    pairs.push_back({.index = static_cast<std::size_t>(i),
                     .stamp = from_seconds(0.1 * i),
                     .estimate = pose,
                     .truth = pose});
  }
  return pairs;
}

TEST(TrajectoryError, ConstantOffsetIsTheRmse) {
  auto pairs = straight_pairs();
  for (PosePair& pair : pairs) pair.estimate.translation += Eigen::Vector3d(3, 4, -12);
  const auto error = trajectory_error(pairs);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->position->rmse_m, 13, 1e-12);
  EXPECT_NEAR(error->position->max_m, 13, 1e-12);
  EXPECT_NEAR(error->position->end->horizontal_m, 5, 1e-12);
  EXPECT_NEAR(error->position->end->vertical_m, 12, 1e-12);
  EXPECT_NEAR(error->attitude->tilt_rmse_rad, 0, 1e-12);
  EXPECT_NEAR(error->attitude->yaw_rmse_rad, 0, 1e-12);
}

// Error k/100 at pair k of 0..n: mean square = (2n + 1)(n)/(6 * 100^2).
TEST(TrajectoryError, LinearlyGrowingErrorMatchesClosedForm) {
  auto pairs = straight_pairs();
  for (int i = 0; i <= 100; ++i) pairs[i].estimate.translation.y() += 0.01 * i;
  EXPECT_NEAR(trajectory_error(pairs)->position->rmse_m, std::sqrt(100.0 * 201 / 6e4), 1e-12);
}

TEST(TrajectoryError, SeparatesTiltFromYaw) {
  auto pairs = straight_pairs();
  for (PosePair& pair : pairs) {
    pair.estimate.rotation = so3_exp({0.03, 0.04, 0}) * so3_exp({0, 0, -3.1}) * pair.truth.rotation;
  }
  const auto error = trajectory_error(pairs);
  EXPECT_NEAR(error->attitude->tilt_rmse_rad, 0.05, 1e-7);
  EXPECT_NEAR(error->attitude->yaw_rmse_rad, 3.1, 1e-7);
}

TEST(TrajectoryError, IsEmptyForOnePair) {
  std::vector<PosePair> pairs = straight_pairs();
  for (std::size_t i = 1; i < pairs.size(); ++i) pairs[i].is_metric = false;
  EXPECT_FALSE(trajectory_error(pairs)->position);
  EXPECT_TRUE(trajectory_error(pairs)->attitude);
  EXPECT_FALSE(trajectory_error({pairs.data(), 1}));
}

TEST(TrajectoryError, ReturnsNothingWithoutPairs) {
  EXPECT_FALSE(trajectory_error({}));
  EXPECT_EQ(path_length_m({}), 0);
  EXPECT_FALSE(relative_error_over_frames({}, 1));
  EXPECT_FALSE(relative_error_over_distance({}, 1));
}

// Scale error of 2 %: every step of d metres has an error of 0.02 d.
TEST(RelativeError, ScaleErrorIsProportionalToStepLength) {
  auto pairs = straight_pairs();
  for (PosePair& pair : pairs) pair.estimate.translation *= 1.02;
  const auto frame = relative_error_over_frames(pairs, 1);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->count, 100);
  EXPECT_NEAR(frame->translation_rmse_m, 0.02, 1e-12);
  EXPECT_NEAR(*frame->rotation_rmse_rad, 0, 1e-7);
  const auto far = relative_error_over_distance(pairs, 25);
  ASSERT_TRUE(far);
  EXPECT_EQ(far->count, 76);
  EXPECT_NEAR(far->translation_rmse_m, 0.5, 1e-12);
  EXPECT_NEAR(far->mean_length_m, 25, 1e-12);
  EXPECT_FALSE(relative_error_over_distance(pairs, 101));
}

TEST(RelativeError, ConstantYawDriftGivesRotationError) {
  auto pairs = straight_pairs();
  for (int i = 0; i <= 100; ++i) {
    pairs[i].estimate.rotation = so3_exp({0, 0, 0.001 * i}) * pairs[i].truth.rotation;
  }
  EXPECT_NEAR(*relative_error_over_frames(pairs, 5)->rotation_rmse_rad, 0.005, 1e-9);
}

TEST(VectorError, MatchesGainAndOffset) {
  std::vector<Eigen::Vector3d> truth;
  std::vector<Eigen::Vector3d> estimate;
  for (int i = 0; i < 5; ++i) {
    truth.emplace_back(i, i, i);
    estimate.emplace_back(i + 0.5, -2.0 * i, 7);
  }
  const auto error = vector_error(estimate, truth);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->samples, 5);
  EXPECT_NEAR(error->rmse.x(), 0.5, 1e-12);
  EXPECT_NEAR(error->rmse.y(), std::sqrt(9 * (0. + 1 + 4 + 9 + 16) / 5), 1e-12);
  EXPECT_NEAR(error->median_abs.y(), 6, 1e-12);
  EXPECT_NEAR(*error->correlation[0], 1, 1e-12);
  EXPECT_NEAR(*error->correlation[1], -1, 1e-12);
  EXPECT_FALSE(error->correlation[2]);
}

TEST(VectorError, MedianOfEvenCountAveragesTheTwoMiddleErrors) {
  const std::vector<Eigen::Vector3d> truth(4, Eigen::Vector3d::Zero());
  const std::vector<Eigen::Vector3d> estimate{{9, 0, 0}, {-1, 0, 0}, {3, 0, 0}, {2, 0, 0}};
  EXPECT_NEAR(vector_error(estimate, truth)->median_abs.x(), 2.5, 1e-12);
  EXPECT_FALSE(vector_error({}, {}));
  EXPECT_FALSE(vector_error({truth.data(), 1}, {estimate.data(), 1}));
}

}  // namespace
}  // namespace stillkite
