#include "simulation/hover/hover_estimate_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/camera_mount.hpp"

namespace stillkite {
namespace {

// A drone 1 m and 2 m from its start, 3 m over the floor but believed at 3.1 m, turned by 0.4 rad;
// the estimate misses it by `miss` in the world and by `turn` about the world's axes.
struct Missed {
  CameraTruth truth;
  NavigationEstimate estimate;
  RigidTransform world_from_estimate{.rotation = Eigen::Quaterniond::Identity(),
                                     .translation = {5, 6, -0.1}};
};

Missed missed_by(const Eigen::Vector3d& miss_m, const Eigen::Vector3d& turn) {
  Missed out;
  const RigidTransform world_from_body{so3_exp({0, 0, 0.4}), {6, 8, 3}};
  out.truth = {world_from_body * camera_raised_forward(75), {0.3, 0, 0}};
  out.estimate.verdict = Verdict::ok;
  out.estimate.scale = ScaleSource::initial_height;
  out.estimate.world_from_body = {
      so3_exp(-turn) * world_from_body.rotation,
      world_from_body.translation - miss_m - out.world_from_estimate.translation};
  out.estimate.velocity_in_world_m_s = {0.3, 0.04, -0.03};
  out.estimate.pose_covariance.diagonal() << 1e-4, 4e-4, 9e-4, 1e-6, 1e-6, 4e-6;
  return out;
}

EstimateError error_of_missed(const Missed& missed) {
  return estimate_error(missed.estimate, camera_raised_forward(75), missed.world_from_estimate,
                        missed.truth);
}

TEST(HoverEstimateError, IsNothingAtTheTruth) {
  const EstimateError error = error_of_missed(missed_by({0, 0, 0}, {0, 0, 0}));
  EXPECT_NEAR(error.position_error_m.value(), 0, 1e-12);
  EXPECT_NEAR(error.rotation_error_rad, 0, 1e-12);
  EXPECT_NEAR(error.pose_nees.value(), 0, 1e-12);
  EXPECT_NEAR(error.velocity_error_m_s.value(), 0.05, 1e-12);
}

TEST(HoverEstimateError, CountsEachAxisByItsOwnDeviation) {
  const EstimateError error = error_of_missed(missed_by({0.02, 0.04, -0.03}, {0, 1e-3, 4e-3}));
  EXPECT_NEAR(error.position_error_m.value(), std::sqrt(29e-4), 1e-12);
  EXPECT_NEAR(error.rotation_error_rad, std::sqrt(17e-6), 1e-12);
  EXPECT_NEAR(error.pose_nees.value(), 4 + 4 + 1 + 1 + 4, 1e-6);
}

TEST(HoverEstimateError, HasNoFigureWithoutMetresOrCovariance) {
  Missed missed = missed_by({0.02, 0, 0}, {0, 0, 0});
  missed.estimate.verdict = Verdict::first_frame;
  EXPECT_FALSE(error_of_missed(missed).pose_nees);
  missed.estimate.verdict = Verdict::ok;
  missed.estimate.pose_covariance.setZero();
  EXPECT_FALSE(error_of_missed(missed).pose_nees);
  missed.estimate.source = EstimateSource::reference;
  EXPECT_FALSE(error_of_missed(missed).position_error_m);
  missed.estimate.source = EstimateSource::flow;
  missed.estimate.scale = ScaleSource::none;
  EXPECT_FALSE(error_of_missed(missed).velocity_error_m_s);
}

}  // namespace
}  // namespace stillkite
