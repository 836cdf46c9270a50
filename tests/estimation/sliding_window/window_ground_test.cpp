#include "estimation/sliding_window/window_ground.hpp"

#include <gtest/gtest.h>

#include "estimation/sliding_window/window.hpp"
#include "geometry/rigid_transform.hpp"
#include "true_window.hpp"

namespace stillkite {
namespace {

const WindowGround kHillside{.slope = {0.1, -0.05}, .height_m = -2};
const RigidTransform kGroundWorldFromImu{so3_exp({0.2, -0.1, 0.7}), {1, -2, 3}};
const RigidTransform kGroundImuFromCamera{so3_exp({3.0, 0.1, 0.1}), {0.1, 0.05, -0.2}};

const Eigen::Quaterniond kMoveYaw = so3_exp({0, 0, 0.8});
const Eigen::Vector3d kMoveFrom(1, 2, 3);
const Eigen::Vector3d kMoveTo(-4, 5, 1);

// Height above the slope of a point on a ray at a depth.
double height_above_hillside_m(const InverseDepthPoint& point) {
  const Eigen::Vector3d x = kGroundWorldFromImu * kGroundImuFromCamera *
                            Eigen::Vector3d(point.bearing.homogeneous() / point.inverse_depth);
  return x.z() - kHillside.height_m - kHillside.slope.dot(x.head<2>());
}

TEST(WindowGround, ViewGivesTheHeightOfAPoint) {
  const GroundView view = ground_view(kHillside, kGroundWorldFromImu, kGroundImuFromCamera);
  const InverseDepthPoint point{{0.2, -0.3}, 0.4};
  EXPECT_NEAR(view.height_ratio(point) / point.inverse_depth, height_above_hillside_m(point),
              1e-12);
}

TEST(WindowGround, PointOnGroundHasNoHeight) {
  const GroundView view = ground_view(kHillside, kGroundWorldFromImu, kGroundImuFromCamera);
  const auto point = point_on_ground(view, {0.1, 0.2});
  ASSERT_TRUE(point);
  EXPECT_NEAR(height_above_hillside_m(*point), 0, 1e-12);
}

TEST(WindowGround, HasNoPointAboveTheHorizon) {
  const RigidTransform forward{so3_exp({-1.5, 0, 0}), Eigen::Vector3d::Zero()};  // axis to +y
  const GroundView view = ground_view({}, {Eigen::Quaterniond::Identity(), {0, 0, 10}}, forward);
  EXPECT_FALSE(point_on_ground(view, {0, -0.5}));
  EXPECT_TRUE(point_on_ground(view, {0, 0.5}));
}

TEST(WindowGround, HeightsDoNotChangeIfTheWindowIsMoved) {
  Window window = true_window();
  window.ground = window.first_ground = kHillside;
  const auto view = [&] {
    return ground_view(window.ground, window.frames[2].state.world_from_imu,
                       window.extrinsics.imu_from_camera);
  };
  const GroundView before = view();
  move_window(window, kMoveYaw, kMoveFrom, kMoveTo);
  EXPECT_LT((view().normal - before.normal).norm(), 1e-12);
  EXPECT_NEAR(view().height_m, before.height_m, 1e-12);
}

TEST(WindowGround, PriorIsTheSameIfTheWindowIsMoved) {
  Window window = true_window();
  window.ground = window.first_ground = kHillside;
  constexpr int kGround = SharedIndex::kGround;
  window.prior.gradient.segment<3>(kGround) << 3, -2, 5;
  const GroundError error(0.01, -0.02, 0.3);
  const double before = error.dot(window.prior.gradient.segment<3>(kGround));
  Window changed = window;
  changed.ground = plus(changed.ground, error);
  move_window(window, kMoveYaw, kMoveFrom, kMoveTo);
  move_window(changed, kMoveYaw, kMoveFrom, kMoveTo);
  const GroundError moved = minus(changed.ground, window.ground);
  EXPECT_NEAR(moved.dot(window.prior.gradient.segment<3>(kGround)), before, 1e-12);
}

}  // namespace
}  // namespace stillkite
