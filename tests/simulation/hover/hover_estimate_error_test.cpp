#include "simulation/hover/hover_estimate_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/camera_mount.hpp"

namespace stillkite {
namespace {

// Drone at 1 m and 2 m from its initial position, yaw 0.4 rad, height 3 m, initial height error
// 0.1 m. The estimate has the given position and rotation errors in the world frame.
struct ErrorCase {
  CameraTruth truth;
  NavigationEstimate estimate;
  RigidTransform world_from_estimate{.rotation = Eigen::Quaterniond::Identity(),
                                     .translation = {5, 6, -0.1}};
};

ErrorCase case_with_error(const Eigen::Vector3d& position_error_m,
                          const Eigen::Vector3d& rotation_error_rad) {
  ErrorCase out;
  const RigidTransform world_from_body{so3_exp({0, 0, 0.4}), {6, 8, 3}};
  out.truth = {world_from_body * camera_raised_forward(75), {0.3, 0, 0}};
  out.estimate.verdict = Verdict::ok;
  out.estimate.scale = ScaleSource::initial_height;
  out.estimate.world_from_body = {
      so3_exp(-rotation_error_rad) * world_from_body.rotation,
      world_from_body.translation - position_error_m - out.world_from_estimate.translation};
  out.estimate.velocity_in_world_m_s = {0.3, 0.04, -0.03};
  out.estimate.pose_covariance.diagonal() << 1e-4, 4e-4, 9e-4, 1e-6, 1e-6, 4e-6;
  return out;
}

EstimateError error_of(const ErrorCase& sample) {
  return estimate_error(sample.estimate, camera_raised_forward(75), sample.world_from_estimate,
                        sample.truth);
}

TEST(HoverEstimateError, IsZeroAtGroundTruth) {
  const EstimateError error = error_of(case_with_error({0, 0, 0}, {0, 0, 0}));
  EXPECT_NEAR(error.position_error_m.value(), 0, 1e-12);
  EXPECT_NEAR(error.rotation_error_rad, 0, 1e-12);
  EXPECT_NEAR(error.pose_nees.value(), 0, 1e-12);
  EXPECT_NEAR(error.velocity_error_m_s.value(), 0.05, 1e-12);
}

TEST(HoverEstimateError, NeesWeightsAxesByVariance) {
  const EstimateError error = error_of(case_with_error({0.02, 0.04, -0.03}, {0, 1e-3, 4e-3}));
  EXPECT_NEAR(error.position_error_m.value(), std::sqrt(29e-4), 1e-12);
  EXPECT_NEAR(error.rotation_error_rad, std::sqrt(17e-6), 1e-12);
  EXPECT_NEAR(error.pose_nees.value(), 4 + 4 + 1 + 1 + 4, 1e-6);
}

TEST(HoverEstimateError, IsUndefinedWithoutScaleOrCovariance) {
  ErrorCase sample = case_with_error({0.02, 0, 0}, {0, 0, 0});
  sample.estimate.verdict = Verdict::first_frame;
  EXPECT_FALSE(error_of(sample).pose_nees);
  sample.estimate.verdict = Verdict::ok;
  sample.estimate.pose_covariance.setZero();
  EXPECT_FALSE(error_of(sample).pose_nees);
  sample.estimate.source = EstimateSource::reference;
  EXPECT_FALSE(error_of(sample).position_error_m);
  sample.estimate.source = EstimateSource::flow;
  sample.estimate.scale = ScaleSource::none;
  EXPECT_FALSE(error_of(sample).velocity_error_m_s);
}

}  // namespace
}  // namespace stillkite
