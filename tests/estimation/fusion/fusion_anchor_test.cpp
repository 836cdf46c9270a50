#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "estimation/fusion/fusion_filter.hpp"
#include "tests/estimation/fusion/fusion_scene.hpp"

namespace stillkite {
namespace {

// A new anchor is the camera with all its doubt: nothing is known better, nothing worse.
TEST(FusionFilter, ANewAnchorKeepsThePoseAndItsCovariance) {
  FusionSimulation flight(FusionScene{}, FusionConfig{}, 6);
  for (int i = 0; i < 60; ++i) flight.step();
  const Matrix6d before = flight.filter().pose_covariance();
  flight.filter().take_anchor();
  EXPECT_LT((flight.filter().pose_covariance() - before).norm(), 1e-15);
}

// The same points from elsewhere: their depth is theirs, and known as well as before.
TEST(FusionFilter, ANewAnchorKeepsTheDepthsOfWhatIsInView) {
  FusionScene scene;
  scene.renew_every_s = 2;
  FusionSimulation flight(scene, few_landmarks(), 6);
  for (int i = 0; i < 59; ++i) flight.step();
  const std::vector<Landmark> before = flight.filter().landmarks();
  const RigidTransform first = flight.filter().state().world_from_anchor;
  const double scale_sigma = flight.filter().scale_sigma();
  for (int i = 0; i < 3; ++i) flight.step();
  const std::vector<Landmark>& after = flight.filter().landmarks();
  ASSERT_GE(after.size(), 8u);
  const RigidTransform anchor = flight.filter().state().world_from_anchor;
  EXPECT_GT((anchor.translation - first.translation).norm(), 0.1) << "it has not moved";
  for (const Landmark& landmark : after) {
    const auto same = std::find_if(before.begin(), before.end(), [&](const Landmark& l) {
      return l.feature == landmark.feature;
    });
    ASSERT_NE(same, before.end());
    const Eigen::Vector3d place = first * (same->bearing.homogeneous() / same->inverse_depth);
    const double inverse_depth = 1 / (anchor.inverse() * place).z();
    EXPECT_NEAR(landmark.inverse_depth / inverse_depth, 1, 0.05) << landmark.feature;
  }
  EXPECT_LT(flight.filter().scale_sigma(), 1.05 * scale_sigma);
}

// Sigma of what all depths are wrong by, as a share.
double common_depth_sigma(const FusionMap& map) {
  const auto count = std::ssize(map.landmarks);
  const Eigen::Index first = map.covariance.rows() - 3 * count;
  double sum = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      sum += map.covariance(first + 3 * i + 2, first + 3 * j + 2) /
             (map.landmarks[static_cast<std::size_t>(i)].inverse_depth *
              map.landmarks[static_cast<std::size_t>(j)].inverse_depth);
    }
  }
  return std::sqrt(sum) / static_cast<double>(count);
}

// Else each linearisation would move it a little: no view tells it, but all views touch depths.
TEST(FusionFilter, WhatAllDepthsAreWrongByIsTheScales) {
  FusionScene scene;
  scene.has_landmarks = false;
  scene.inverse_depth_spread = 0.2;
  FusionConfig config = few_landmarks();
  config.inverse_depth_sigma_ratio = scene.inverse_depth_spread;
  FusionSimulation flight(scene, config, 6);
  for (int i = 0; i < 50; ++i) flight.step();
  FusionFilter& filter = flight.filter();
  const Matrix6d pose = filter.pose_covariance();
  const Matrix6d anchored = filter.anchored_covariance();
  const Eigen::Matrix3d velocity = filter.velocity_covariance();
  const Eigen::Vector3d step = filter.step_m();
  const Eigen::Matrix3d of_step = filter.step_covariance();
  const double scale_sigma = filter.scale_sigma();
  const double unsettled = common_depth_sigma(filter.map());
  filter.settle_unit();
  EXPECT_LT(common_depth_sigma(filter.map()), 0.01 * unsettled);
  EXPECT_NEAR(filter.scale_sigma(), std::hypot(scale_sigma, unsettled), 0.01 * unsettled);
  // in metres nothing is known better, nothing worse
  EXPECT_LT((filter.pose_covariance() - pose).norm(), 1e-9 * pose.norm());
  EXPECT_LT((filter.anchored_covariance() - anchored).norm(), 1e-9 * anchored.norm());
  EXPECT_LT((filter.velocity_covariance() - velocity).norm(), 1e-9 * velocity.norm());
  EXPECT_LT((filter.step_m() - step).norm(), 1e-9 * step.norm());
  EXPECT_LT((filter.step_covariance() - of_step).norm(), 1e-9 * of_step.norm());
}

// Each frame's views leave it so, also where the landmarks come and go.
TEST(FusionFilter, ViewsLeaveTheUnitSettled) {
  FusionScene scene;
  scene.pixel_sigma_px = 0.2;
  scene.renew_every_s = 1;
  FusionSimulation flight(scene, few_landmarks(), 6);
  for (int i = 0; i < 50; ++i) flight.step();
  const FusionFilter& filter = flight.filter();
  EXPECT_LT(common_depth_sigma(filter.map()), 0.3 * filter.scale_sigma());
}

// Landmarks without a feature near them are no more.
TEST(FusionFilter, ALandmarkThatIsNotInTheNewReferenceIsDropped) {
  FusionSimulation flight(FusionScene{}, few_landmarks(), 6);
  for (int i = 0; i < 60; ++i) flight.step();
  flight.filter().take_anchor();
  ASSERT_GE(flight.filter().landmarks().size(), 8u);
  const Landmark kept = flight.filter().landmarks()[2];
  const Eigen::Vector2d beside = kept.bearing + Eigen::Vector2d(1e-3, 0);
  flight.filter().number_landmarks(
      std::vector<FeatureView>{
          {40, beside, 1e-6 * Eigen::Matrix2d::Identity()},
          {41, kept.bearing + Eigen::Vector2d(0.5, 0.5), 1e-6 * Eigen::Matrix2d::Identity()}},
      5e-3);
  ASSERT_EQ(flight.filter().landmarks().size(), 1u);
  EXPECT_EQ(flight.filter().landmarks()[0].feature, 40);
  EXPECT_EQ(flight.filter().landmarks()[0].bearing, beside);
  EXPECT_EQ(flight.filter().landmarks()[0].inverse_depth, kept.inverse_depth);
}

// Anchor, landmarks and what is known of them, whatever came between.
TEST(FusionFilter, ARestoredMapIsTheOneThatWasLeft) {
  FusionSimulation flight(FusionScene{}, FusionConfig{}, 10);
  for (int i = 0; i < 30; ++i) flight.step();
  flight.filter().take_anchor();  // the first one is exact
  flight.filter().number_landmarks({}, 0);
  flight.filter().add_landmark({7, {0.1, -0.2}, 1e-6 * Eigen::Matrix2d::Identity()});
  flight.cover(true);
  const FusionMap left = flight.filter().map();
  for (int i = 0; i < 30; ++i) flight.step();
  flight.filter().take_anchor();
  flight.filter().restore(left);
  const FusionMap back = flight.filter().map();
  EXPECT_EQ(back.covariance, left.covariance);
  EXPECT_GT(back.covariance.topLeftCorner(6, 6).trace(), 0);
  EXPECT_EQ(back.world_from_anchor.translation, left.world_from_anchor.translation);
  ASSERT_EQ(back.landmarks.size(), 1u);
  EXPECT_EQ(back.landmarks[0].feature, 7);
}

}  // namespace
}  // namespace stillkite
