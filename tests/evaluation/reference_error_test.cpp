#include "evaluation/reference_error.hpp"

#include <gtest/gtest.h>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

const RigidTransform kMount{Eigen::Quaterniond(Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitX())),
                            {0.1, -0.2, 0.05}};

std::vector<StampedPose> truth() {
  std::vector<StampedPose> poses;
  poses.reserve(5);
  for (int i = 0; i < 5; ++i) {
    poses.push_back({from_seconds(i),
                     {so3_exp(Eigen::Vector3d(0.02, -0.01, 0.05) * i), {0.4 * i, 0.1 * i, 2}}});
  }
  return poses;
}

// Truth with a rotation error and a direction error.
std::vector<NavigationEstimate> estimates(double rotation_error_deg, double direction_error_deg,
                                          DisplacementKind kind) {
  const std::vector<StampedPose> poses = truth();
  std::vector<NavigationEstimate> result;
  for (const StampedPose& pose : poses) {
    const RigidTransform reference_from_camera =
        (poses.front().world_from_body * kMount).inverse() * (pose.world_from_body * kMount);
    NavigationEstimate estimate;
    estimate.stamp = pose.stamp;
    estimate.verdict = pose.stamp.ns == 0 ? Verdict::first_frame : Verdict::ok;
    estimate.reference.emplace();
    estimate.reference->reference_stamp = poses.front().stamp;
    MotionEstimate& motion = estimate.reference->motion;
    motion.status = EstimateStatus::ok;
    motion.reference_from_camera = so3_exp(Eigen::Vector3d(0, rotation_error_deg * kDegree, 0)) *
                                   reference_from_camera.rotation;
    const Eigen::Vector3d axis = reference_from_camera.translation.unitOrthogonal();
    motion.displacement_in_reference =
        so3_exp(axis * direction_error_deg * kDegree) * reference_from_camera.translation;
    if (kind == DisplacementKind::direction) motion.displacement_in_reference.normalize();
    motion.displacement_kind = kind;
    result.push_back(estimate);
  }
  return result;
}

TEST(ReferenceError, ReportsRotationAndDirectionErrors) {
  const auto error =
      reference_error(estimates(0.3, 2, DisplacementKind::direction), truth(), kMount, 0.01);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->rotations, 4);
  EXPECT_EQ(error->directions, 4);
  EXPECT_NEAR(error->rotation_median_deg, 0.3, 1e-9);
  EXPECT_NEAR(*error->direction_median_deg, 2, 1e-9);
  EXPECT_FALSE(error->displacement_rmse_m);
}

TEST(ReferenceError, ReportsMetricDisplacementError) {
  auto metric = estimates(0, 0, DisplacementKind::metric);
  for (NavigationEstimate& e : metric) e.reference->motion.displacement_in_reference.x() += 0.25;
  const auto error = reference_error(metric, truth(), kMount, 0.01);
  ASSERT_TRUE(error && error->displacement_rmse_m);
  EXPECT_NEAR(*error->displacement_rmse_m, 0.25, 1e-9);
}

TEST(ReferenceError, CountsOnlyFramesWithStatusOk) {
  auto lost = estimates(1, 1, DisplacementKind::direction);
  for (NavigationEstimate& e : lost) e.reference->motion.status = EstimateStatus::lost;
  EXPECT_FALSE(reference_error(lost, truth(), kMount, 0.01));
  EXPECT_FALSE(reference_error(estimates(1, 1, DisplacementKind::direction), {}, kMount, 0.01));
}

}  // namespace
}  // namespace stillkite
