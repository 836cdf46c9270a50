#include "geometry/plane.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/geometry/random_values.hpp"

namespace stillkite {
namespace {

// Nadir camera, x axes of camera and world parallel.
const Eigen::Quaterniond kNadir(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));

TEST(GroundPlane, InverseDepthOfNadirCameraIsInverseHeight) {
  const GroundPlane ground = ground_plane_in_camera({kNadir, {7.0, -3.0, 40.0}});
  EXPECT_TRUE(ground.normal_in_camera.isApprox(Eigen::Vector3d::UnitZ(), 1e-15));
  EXPECT_EQ(ground.height_m, 40.0);
  for (const Eigen::Vector2d& bearing : {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.5, -0.3)}) {
    EXPECT_NEAR(inverse_depth(ground, bearing), 1.0 / 40.0, 1e-16);
  }
}

TEST(GroundPlane, LevelCameraHasHorizonAtCentre) {
  // z forward along the world's x, y down
  const Eigen::Quaterniond forward((Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished());
  const GroundPlane ground = ground_plane_in_camera({forward, {0, 0, 2.0}});
  EXPECT_NEAR(inverse_depth(ground, {0.4, 0.0}), 0.0, 1e-15);
  EXPECT_NEAR(inverse_depth(ground, {0.4, 0.5}), 0.25, 1e-15);  // 2 m down at 4 m ahead
  EXPECT_LT(inverse_depth(ground, {0.4, -0.1}), 0.0);
}

TEST(GroundPlane, InverseDepthMatchesRayIntersection) {
  std::mt19937 random(1);
  int below_horizon = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d position = random_vector(random, 5.0) + Eigen::Vector3d(0, 0, 20.0);
    const RigidTransform world_from_camera{random_rotation(random), position};
    const Eigen::Vector2d bearing = random_vector(random, 1.0).head<2>();
    const double rho = inverse_depth(ground_plane_in_camera(world_from_camera), bearing);

    const Eigen::Vector3d ray_in_world = world_from_camera.rotation * bearing.homogeneous();
    // ray z = 0 at depth d: position.z + d * ray.z = 0
    EXPECT_NEAR(rho, -ray_in_world.z() / position.z(), 1e-14);
    if (rho <= 1e-6) continue;
    ++below_horizon;
    const Eigen::Vector3d on_ground = world_from_camera * (bearing.homogeneous() / rho);
    EXPECT_NEAR(on_ground.z(), 0.0, 1e-9 / rho);
  }
  EXPECT_GT(below_horizon, 100);
}

}  // namespace
}  // namespace stillkite
