#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "estimation/ego_motion/motion_field.hpp"
#include "tests/estimation/ego_motion/flow_scene.hpp"

namespace stillkite {
namespace {

constexpr double kDifferenceStep_s = 1e-5;

// Image of a static point after the camera has moved with the twist for t_s.
Eigen::Vector2d projection_after(const Twist& twist, const Eigen::Vector3d& point_in_camera,
                                 double t_s) {
  const RigidTransform before_from_after{
      so3_exp(twist.angular_rate_rad_s * t_s),
      so3_left_jacobian(twist.angular_rate_rad_s * t_s) * twist.velocity_m_s * t_s};
  const Eigen::Vector3d moved = before_from_after.inverse() * point_in_camera;
  return moved.head<2>() / moved.z();
}

Eigen::Quaterniond random_attitude(std::mt19937& random) {
  return so3_exp(test::random_vector(random, 3.0));
}

TEST(MotionField, IsDerivativeOfProjectionAtAnyAttitude) {
  std::mt19937 random(1);
  int below_horizon = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const RigidTransform world_from_camera{random_attitude(random), {5, 7, 0.5 + trial}};
    const Twist twist{test::random_vector(random, 20), test::random_vector(random, 1)};
    const Eigen::Vector2d bearing = test::random_vector(random, 0.8).head<2>();
    const GroundPlane ground = ground_plane_in_camera(world_from_camera);
    const double rho = inverse_depth(ground, bearing);
    if (rho > 0) ++below_horizon;
    // above the horizon: point at infinity
    const Eigen::Vector3d point = bearing.homogeneous() / (rho > 0 ? rho : 1e-12);
    const Eigen::Vector2d derivative = (projection_after(twist, point, kDifferenceStep_s) -
                                        projection_after(twist, point, -kDifferenceStep_s)) /
                                       (2 * kDifferenceStep_s);
    const Eigen::Vector2d linear = motion_field(ground, bearing) * twist.vector();
    EXPECT_LT((linear - derivative).norm(), 1e-6 * (1 + linear.norm())) << "trial " << trial;
  }
  EXPECT_GT(below_horizon, 100);
  EXPECT_LT(below_horizon, 200);
}

TEST(MotionField, InPixelsIsDerivativeOfDistortedProjection) {
  std::mt19937 random(2);
  test::FlowScene scene;
  for (const DistortionModel model :
       {DistortionModel::none, DistortionModel::radial_tangential, DistortionModel::equidistant}) {
    scene.camera.distortion = model;
    for (int trial = 0; trial < 50; ++trial) {
      const Twist twist{test::random_vector(random, 3), test::random_vector(random, 1)};
      const Eigen::Vector2d bearing = test::random_vector(random, 0.5).head<2>();
      const double rho = inverse_depth(scene.ground(), bearing);
      const Eigen::Vector3d point = bearing.homogeneous() / rho;
      const Eigen::Vector2d derivative =
          (distort(scene.camera, projection_after(twist, point, kDifferenceStep_s)).pixel -
           distort(scene.camera, projection_after(twist, point, -kDifferenceStep_s)).pixel) /
          (2 * kDifferenceStep_s);
      const Eigen::Vector2d linear =
          motion_field_px(scene.camera, scene.ground(), bearing) * twist.vector();
      EXPECT_LT((linear - derivative).norm(), 1e-5 * (1 + linear.norm()));
    }
  }
}

TEST(MotionField, PaperFormMatchesFieldInWorldAxes) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const RigidTransform world_from_camera{random_attitude(random), {0, 0, 40}};
    const Eigen::Vector3d V = test::random_vector(random, 20);
    const Eigen::Vector3d w = test::random_vector(random, 1);
    const Eigen::Vector2d bearing = test::random_vector(random, 0.8).head<2>();
    const PaperMotionField field = paper_motion_field(world_from_camera, bearing);
    const Twist twist{world_from_camera.rotation.conjugate() * V, w};
    const Eigen::Vector2d expected =
        motion_field(ground_plane_in_camera(world_from_camera), bearing) * twist.vector();
    EXPECT_LT((field.D1 * V.head<2>() + field.D2 * w + field.D3 * V.z() - expected).norm(), 1e-12);
  }
}

TEST(MotionField, MatchesTextbookFormulaAtNadir) {
  // camera x along world x, y along world -y, z down: xi' = -V_x / h, eta' = V_y / h at the centre;
  // descent expands the field from there
  const RigidTransform nadir{Eigen::Quaterniond(0, 1, 0, 0), {0, 0, 50}};
  const PaperMotionField centre = paper_motion_field(nadir, {0, 0});
  EXPECT_NEAR(centre.D1(0, 0), -1.0 / 50, 1e-15);
  EXPECT_NEAR(centre.D1(1, 1), 1.0 / 50, 1e-15);
  EXPECT_NEAR(centre.D3.norm(), 0, 1e-15);
  const PaperMotionField off_centre = paper_motion_field(nadir, {0.3, -0.2});
  EXPECT_NEAR(-off_centre.D3.x(), 0.3 / 50, 1e-15);
  EXPECT_NEAR(-off_centre.D3.y(), -0.2 / 50, 1e-15);
}

TEST(MotionField, IsRotationOnlyAboveHorizon) {
  // level camera, optical axis along world x: sky at negative y
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const GroundPlane ground = ground_plane_in_camera({Eigen::Quaterniond(R), {0, 0, 2}});
  for (const double y : {-0.5, -1e-9, 0.0}) {
    EXPECT_EQ(motion_field(ground, {0.1, y}).leftCols<3>().norm(), 0) << y;
  }
  EXPECT_GT(motion_field(ground, {0.1, 0.2}).leftCols<3>().norm(), 0);
}

}  // namespace
}  // namespace stillkite
