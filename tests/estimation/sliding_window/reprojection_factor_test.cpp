#include "estimation/sliding_window/reprojection_factor.hpp"

#include <gtest/gtest.h>

#include "estimation/sliding_window/inertial_state.hpp"

namespace stillkite {
namespace {

const RigidTransform kHost{so3_exp({0.1, -0.2, 0.4}), {1, 2, 0.5}};
const RigidTransform kTarget{so3_exp({-0.1, -0.1, 0.5}), {1.3, 2.4, 0.7}};
const RigidTransform kImuFromCamera{so3_exp({0.1, 0.2, 1.5}), {-0.02, -0.06, 0.01}};
const InverseDepthPoint kPoint{{0.2, -0.3}, 0.25};

RigidTransform moved_pose(const RigidTransform& pose, const Vector6d& error) {
  InertialError all = InertialError::Zero();
  all.head<6>() = error;
  return plus(InertialState{.world_from_imu = pose}, all).world_from_imu;
}

TEST(ReprojectionFactor, ProjectsToTheBearingOfThePoint) {
  const Eigen::Vector3d in_world =
      kHost * kImuFromCamera * (kPoint.bearing.homogeneous() / kPoint.inverse_depth).eval();
  const Eigen::Vector3d in_target = (kTarget * kImuFromCamera).inverse() * in_world;
  const auto seen = project_point(camera_pair(kHost, kTarget, kImuFromCamera), kPoint);
  ASSERT_TRUE(seen);
  EXPECT_LT((seen->bearing - in_target.hnormalized()).norm(), 1e-12);
}

TEST(ReprojectionFactor, JacobiansAgreeWithDifferences) {
  const CameraPair pair = camera_pair(kHost, kTarget, kImuFromCamera);
  const PairJacobians by = pair_jacobians(pair);
  const auto at = project_point(pair, kPoint);
  ASSERT_TRUE(at);
  constexpr double kStep = 1e-6;
  const auto difference = [&](const auto& bearing, const auto& step) {
    return ((bearing(step) - bearing((-step).eval())) / (2 * kStep)).eval();
  };
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = kStep * Vector6d::Unit(i);
    const Eigen::Vector2d by_host = difference(
        [&](const Vector6d& e) {
          return *project_bearing(camera_pair(moved_pose(kHost, e), kTarget, kImuFromCamera),
                                  kPoint);
        },
        step);
    const Eigen::Vector2d by_target = difference(
        [&](const Vector6d& e) {
          return *project_bearing(camera_pair(kHost, moved_pose(kTarget, e), kImuFromCamera),
                                  kPoint);
        },
        step);
    const Eigen::Vector2d by_extrinsics = difference(
        [&](const Vector6d& e) {
          return *project_bearing(camera_pair(kHost, kTarget, moved_pose(kImuFromCamera, e)),
                                  kPoint);
        },
        step);
    EXPECT_LT((at->by_pair * by.by_host.col(i) - by_host).norm(), 1e-7) << i;
    EXPECT_LT((at->by_pair * by.by_target.col(i) - by_target).norm(), 1e-7) << i;
    EXPECT_LT((at->by_pair * by.by_extrinsics.col(i) - by_extrinsics).norm(), 1e-7) << i;
  }
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
    const Eigen::Vector2d by_point = difference(
        [&](const Eigen::Vector3d& e) {
          return *project_bearing(camera_pair(kHost, kTarget, kImuFromCamera),
                                  {kPoint.bearing + e.head<2>(), kPoint.inverse_depth + e.z()});
        },
        step);
    EXPECT_LT((at->by_point.col(i) - by_point).norm(), 1e-7) << i;
  }
}

TEST(ReprojectionFactor, IsInvariantToTheWorld) {
  const RigidTransform moved{so3_exp({0.3, -1, 0.7}), {3, -2, 5}};
  const auto before = project_bearing(camera_pair(kHost, kTarget, kImuFromCamera), kPoint);
  const auto after =
      project_bearing(camera_pair(moved * kHost, moved * kTarget, kImuFromCamera), kPoint);
  ASSERT_TRUE(before && after);
  EXPECT_LT((*before - *after).norm(), 1e-12);
}

TEST(ReprojectionFactor, RejectsPointsBehindTheCamera) {
  const RigidTransform behind{kHost.rotation * so3_exp({3, 0, 0}), kHost.translation};
  EXPECT_FALSE(project_bearing(camera_pair(kHost, behind, RigidTransform{}), kPoint));
}

}  // namespace
}  // namespace stillkite
