#include "estimation/fusion/landmark_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "estimation/fusion/innovation_consensus.hpp"
#include "evaluation/chi_square.hpp"
#include "simulation/camera_mount.hpp"
#include "tests/estimation/fusion/landmark_flight.hpp"

namespace stillkite {
namespace {

constexpr double kHeight_m = 400;
constexpr double kPixel = 1 / 1152.77;

RigidTransform above_the_origin() {
  return {camera_looking_down(), {0, 0, kHeight_m}};
}

LandmarkFilterConfig without_bias() {
  return {.velocity_bias_sigma_m_s = 0, .rate_bias_sigma_rad_s = 0};
}

Matrix6d pose_variance(const Eigen::Vector3d& position_sigma_m, double rotation_sigma_rad) {
  Vector6d variance;
  variance << position_sigma_m.cwiseAbs2(), Eigen::Vector3d::Constant(square(rotation_sigma_rad));
  return variance.asDiagonal();
}

// A grid of 5 x 4 landmarks, 120 m apart, on hills.
std::vector<KnownLandmark> grid_map(double sigma_m) {
  std::vector<KnownLandmark> map;
  map.reserve(20);
  for (int i = 0; i < 20; ++i) {
    const int row = i / 5;
    map.push_back({{120.0 * row - 180, 120.0 * (i % 5) - 240, 5.0 * std::sin(2.0 * i)},
                   square(sigma_m) * Eigen::Matrix3d::Identity()});
  }
  return map;
}

std::vector<LandmarkSighting> exact_sightings(const std::vector<KnownLandmark>& map,
                                              const RigidTransform& world_from_camera,
                                              double sigma) {
  std::vector<LandmarkSighting> seen;
  seen.reserve(map.size() + 1);
  for (const KnownLandmark& known : map) {
    const Eigen::Vector3d in_camera = world_from_camera.inverse() * known.position_in_world_m;
    seen.push_back({static_cast<int>(seen.size()), in_camera.hnormalized(),
                    square(sigma) * Eigen::Matrix2d::Identity()});
  }
  return seen;
}

int count_of(const std::vector<SightingVerdict>& verdicts, SightingVerdict wanted) {
  return static_cast<int>(std::count(verdicts.begin(), verdicts.end(), wanted));
}

// P = 1 / (1 / P_0 + 1 / (s^2 + h^2 r / n)): the map's metre s stays however often it is seen.
TEST(LandmarkFilter, ALandmarksOwnErrorIsNotAveragedAway) {
  const std::vector<KnownLandmark> map{{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()}};
  LandmarkFilter filter(without_bias(), map, above_the_origin(),
                        pose_variance({100, 100, 1e-6}, 1e-9));
  const std::vector<LandmarkSighting> seen = exact_sightings(map, above_the_origin(), kPixel);
  const auto variance_after = [](int used, double before) {
    return 1 / (1 / before + 1 / (1 + square(kHeight_m * kPixel) / used));
  };
  EXPECT_EQ(filter.update(seen)[0], SightingVerdict::awaiting);
  for (int n = 1; n <= 1000; ++n) {
    ASSERT_EQ(filter.update(seen)[0], SightingVerdict::used);
    if (n != 1 && n != 10 && n != 1000) continue;
    for (const int axis : {0, 1}) {
      EXPECT_NEAR(filter.pose_covariance()(axis, axis), variance_after(n, 1e4), 1e-4);
    }
  }
  // away, which forgets the place, and back over the same landmark
  filter.predict({}, pose_variance({100, 100, 1e-6}, 1e-9), 1);
  for (int n = 0; n < 1000; ++n) (void)filter.update(seen);
  EXPECT_NEAR(filter.pose_covariance()(0, 0), 1, 1e-3);
  EXPECT_NEAR(filter.landmark(0).covariance_m2(0, 0), 1, 1e-3);
}

// Off by a degree and some metres, of which one linear step leaves a hundred times more.
TEST(LandmarkFilter, ExactBearingsToExactLandmarksGiveTheExactPose) {
  const std::vector<KnownLandmark> map = grid_map(1e-5);
  const RigidTransform truth{so3_exp({0.02, -0.03, 0.4}) * camera_looking_down(), {20, -30, 395}};
  const RigidTransform start{so3_exp({0.015, -0.01, 0.02}) * truth.rotation,
                             truth.translation + Eigen::Vector3d(3, -2, 4)};
  LandmarkFilter filter(without_bias(), map, start, pose_variance({4, 4, 4}, 0.02));
  const std::vector<LandmarkSighting> seen = exact_sightings(map, truth, 1e-6);
  (void)filter.update(seen);
  EXPECT_EQ(count_of(filter.update(seen), SightingVerdict::used), 20);
  EXPECT_LT((filter.world_from_camera().translation - truth.translation).norm(), 5e-4);
  EXPECT_LT(angle_between_rad(filter.world_from_camera().rotation, truth.rotation), 2e-5);
}

TEST(LandmarkFilter, AFalseAssociationChangesNothing) {
  const std::vector<KnownLandmark> map = grid_map(1);
  LandmarkFilter filter(without_bias(), map, above_the_origin(), pose_variance({1, 1, 1}, 0.01));
  std::vector<LandmarkSighting> seen = exact_sightings(map, above_the_origin(), kPixel);
  for (int frame = 0; frame < 6; ++frame) (void)filter.update(seen);
  LandmarkFilter deceived = filter;
  (void)filter.update(seen);
  seen.push_back({3, seen[7].bearing, seen[7].covariance});  // another's place
  seen.push_back({4, seen[4].bearing + Eigen::Vector2d(12 * kPixel, 0), seen[4].covariance});
  seen.push_back({-1, seen[0].bearing, seen[0].covariance});
  seen.push_back({20, seen[0].bearing, seen[0].covariance});
  seen.push_back({0, Eigen::Vector2d(std::nan(""), 0), seen[0].covariance});
  const std::vector<SightingVerdict> verdicts = deceived.update(seen);
  EXPECT_EQ(count_of(verdicts, SightingVerdict::used), 20);
  EXPECT_EQ(count_of(verdicts, SightingVerdict::refused), 5);
  EXPECT_EQ(deceived.world_from_camera().translation, filter.world_from_camera().translation);
  EXPECT_EQ(deceived.pose_covariance(), filter.pose_covariance());
}

// 2 m beside it on the ground could be the map's error, so only that it does not stay there tells.
TEST(LandmarkFilter, AFirstSightingThatDoesNotRepeatNeverCounts) {
  const std::vector<KnownLandmark> map = grid_map(1);
  LandmarkFilter filter(without_bias(), map, above_the_origin(), pose_variance({1, 1, 1}, 0.01));
  const std::vector<LandmarkSighting> exact = exact_sightings(map, above_the_origin(), kPixel);
  for (int frame = 0; frame < 12; ++frame) {
    std::vector<LandmarkSighting> seen = exact;
    seen[9].bearing += (frame % 2 == 0 ? 3.0 : -3.0) * kPixel * Eigen::Vector2d(1, 1);
    (void)filter.update(seen);
  }
  EXPECT_EQ(filter.landmarks(), 19);
  EXPECT_LT((filter.world_from_camera().translation - Eigen::Vector3d(0, 0, kHeight_m)).norm(),
            1e-9);
}

// All off by 20 alike, as a vague pose has them, which hides from each alone what is off by 15.
TEST(InnovationConsensus, LeavesOutWhatDoesNotShareTheCommonError) {
  const int rows = 16;
  Eigen::VectorXd residual = Eigen::VectorXd::Constant(rows, 20);
  for (const int false_one : {1, 4, 6}) residual[2 * false_one] += false_one == 4 ? -15 : 15;
  const Eigen::MatrixXd S =
      Eigen::MatrixXd::Constant(rows, rows, 400) + Eigen::MatrixXd::Identity(rows, rows);
  EXPECT_EQ(largest_consensus(residual, S, 4),
            (std::vector<bool>{true, false, true, true, false, true, false, true}));
  EXPECT_TRUE(largest_consensus({}, {}, 4).empty());
}

// Straight ahead for L: e_p = e_R x L; white noise of the twist adds n (sigma dt)^2.
TEST(LandmarkFilter, DeadReckoningsCovarianceIsItsClosedForm) {
  constexpr double kTilt_rad = 0.01, kNoise_m_s = 0.2, kDt_s = 0.04;
  constexpr int kFrames = 250;
  LandmarkFilter filter(without_bias(), {}, above_the_origin(),
                        pose_variance(Eigen::Vector3d::Zero(), kTilt_rad));
  const Eigen::Vector3d ahead_in_camera(0, -10, 0);  // the world's x
  Matrix6d noise = Matrix6d::Zero();
  noise.topLeftCorner<3, 3>() = square(kNoise_m_s) * Eigen::Matrix3d::Identity();
  for (int i = 0; i < kFrames; ++i) filter.predict({ahead_in_camera, {0, 0, 0}}, noise, kDt_s);
  const double way_m = 10 * kFrames * kDt_s;
  const double white = kFrames * square(kNoise_m_s * kDt_s);
  EXPECT_NEAR(filter.world_from_camera().translation.x(), way_m, 1e-9);
  const Matrix6d P = filter.pose_covariance();
  EXPECT_NEAR(P(0, 0), white, 1e-9);
  EXPECT_NEAR(P(1, 1), square(way_m * kTilt_rad) + white, 1e-9);
  EXPECT_NEAR(P(2, 2), square(way_m * kTilt_rad) + white, 1e-9);
  EXPECT_NEAR(P(2, 4), -way_m * square(kTilt_rad), 1e-9);
  EXPECT_NEAR(P(1, 5), way_m * square(kTilt_rad), 1e-9);
}

// Integrated Gauss-Markov noise: 2 s^2 tau (T - tau (1 - exp(-T / tau))).
TEST(LandmarkFilter, ASlowBiasDriftsAsItsClosedForm) {
  constexpr double kTau_s = 50, kBias_m_s = 0.1, kDt_s = 0.04, kEnd_s = 120;
  LandmarkFilter filter({.velocity_bias_sigma_m_s = kBias_m_s,
                         .rate_bias_sigma_rad_s = 0,
                         .bias_correlation_s = kTau_s},
                        {}, above_the_origin(), Matrix6d::Zero());
  for (int i = 0; i < std::lround(kEnd_s / kDt_s); ++i) filter.predict({}, Matrix6d::Zero(), kDt_s);
  const double variance =
      2 * square(kBias_m_s) * kTau_s * (kEnd_s - kTau_s * (1 - std::exp(-kEnd_s / kTau_s)));
  EXPECT_NEAR(filter.pose_covariance()(0, 0) / variance, 1, 2e-3);
}

// A place for three only: who is not seen goes, and what it left in the pose is not counted twice.
TEST(LandmarkFilter, WhatLeavesTheStateDoesNotComeBack) {
  const std::vector<KnownLandmark> map = grid_map(1);
  LandmarkFilterConfig config = without_bias();
  config.most_landmarks = 3;
  LandmarkFilter filter(config, map, above_the_origin(), pose_variance({1, 1, 1}, 0.01));
  const std::vector<LandmarkSighting> all = exact_sightings(map, above_the_origin(), kPixel);
  const std::span<const LandmarkSighting> first(all.data(), 3), second(all.data() + 10, 3);
  (void)filter.update(first);
  EXPECT_EQ(count_of(filter.update(first), SightingVerdict::used), 3);
  const Matrix6d before = filter.pose_covariance();
  (void)filter.update(second);
  EXPECT_EQ(count_of(filter.update(second), SightingVerdict::used), 3);
  EXPECT_EQ(filter.landmarks(), 3);
  EXPECT_EQ(count_of(filter.update(first), SightingVerdict::refused), 3);
  EXPECT_LT(filter.pose_covariance()(0, 0), before(0, 0));
  EXPECT_GT(filter.pose_covariance().llt().matrixL().determinant(), 0);
}

TEST(LandmarkFilter, AMapThatDoesNotTellHowWellItIsKnownIsRefused) {
  const std::vector<KnownLandmark> map{{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()}};
  EXPECT_THROW(LandmarkFilter({}, map, {}, Matrix6d::Identity()), InputError);
}

TEST(LandmarkFilter, BoundsTheDriftOfAPatrol) {
  LandmarkFlight flight(PatrolScene{.landmarks_per_km2 = 100, .frames_per_sighting = 12}, 71);
  double most_m = 0, alone_most_m = 0;
  while (flight.time_s() < 240) {
    flight.step();
    const auto off_m = [&](const RigidTransform& estimate) {
      return flight.error_of(estimate).head<3>().norm();
    };
    most_m = std::max(most_m, off_m(flight.filter().world_from_camera()));
    alone_most_m = std::max(alone_most_m, off_m(flight.dead_reckoned()));
  }
  EXPECT_LT(most_m, 1);
  EXPECT_GT(alone_most_m, 1);
}

TEST(LandmarkFilter, CovarianceIsHonest) {
  constexpr int kSeeds = 40;
  double early = 0, late = 0;
  for (std::uint64_t seed = 101; seed < 101 + kSeeds; ++seed) {
    LandmarkFlight flight(PatrolScene{.landmarks_per_km2 = 50}, seed);
    while (flight.time_s() < 10) flight.step();
    early += flight.nees() / kSeeds;
    while (flight.time_s() < 40) flight.step();
    late += flight.nees() / kSeeds;
  }
  for (const double mean : {early, late}) {
    EXPECT_GT(mean, chi_square_quantile(0.005, 6 * kSeeds) / kSeeds);
    EXPECT_LT(mean, chi_square_quantile(0.995, 6 * kSeeds) / kSeeds);
  }
}

}  // namespace
}  // namespace stillkite
