#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "estimation/ego_motion/integration.hpp"
#include "estimation/ego_motion/kalman_filter.hpp"
#include "estimation/ego_motion/least_squares.hpp"
#include "geometry/angle.hpp"
#include "geometry/euler.hpp"

// Flow paper, steps 3 to 7, on noise-free flow: error of the method itself
// (docs/plane_odometry.md).

namespace stillkite {
namespace {

const Camera kPaperCamera{.width_px = 1920,
                          .height_px = 1080,
                          .focal_x_px = 1152.77,
                          .focal_y_px = 1150.483,
                          .centre_x_px = 969.2111,
                          .centre_y_px = 535.3755};

// Camera below the body: x right, y backward, z down.
const Eigen::Quaterniond kBodyFromCamera(
    (Eigen::Matrix3d() << 0, -1, 0, -1, 0, 0, 0, 0, -1).finished());

// Exact flow of a pixel grid over the ground z = 0.
std::vector<FlowVector> exact_flow(const Camera& camera, const RigidTransform& world_from_previous,
                                   const RigidTransform& world_from_current) {
  const GroundPlane ground = ground_plane_in_camera(world_from_previous);
  const RigidTransform current_from_previous = world_from_current.inverse() * world_from_previous;
  constexpr int kStride_px = 40;
  std::vector<FlowVector> vectors;
  for (int v = kStride_px / 2; v < camera.height_px; v += kStride_px) {
    for (int u = kStride_px / 2; u < camera.width_px; u += kStride_px) {
      const Eigen::Vector2d bearing = undistort(camera, Eigen::Vector2d(u, v)).value();
      const Eigen::Vector3d point = bearing.homogeneous() / inverse_depth(ground, bearing);
      const Eigen::Vector2d projection = project(camera, current_from_previous * point).value();
      vectors.push_back(
          {Eigen::Vector2f(u, v), (projection - Eigen::Vector2d(u, v)).cast<float>()});
    }
  }
  return vectors;
}

// Relative velocity error of the least squares on the exact flow of a constant twist.
double speed_error(double height_m, double speed_m_s, double focal_px,
                   const Eigen::Vector3d& angular_rate_rad_s, double dt_s) {
  Camera camera = kPaperCamera;
  camera.focal_x_px = camera.focal_y_px = focal_px;
  const RigidTransform before{
      to_quaternion({.pitch_rad = 6 * kDegree, .roll_rad = 4 * kDegree}) * kBodyFromCamera,
      {0, 0, height_m}};
  const Twist twist{before.rotation.conjugate() * Eigen::Vector3d(speed_m_s, 0, 0),
                    angular_rate_rad_s};
  const std::vector<FlowVector> vectors =
      exact_flow(camera, before, integrate_twist(before, twist, dt_s));
  EgoMotionSolver solver(camera, {.weighting = Weighting::plain});
  const EgoMotion motion = solver.solve(vectors, ground_plane_in_camera(before), dt_s);
  EXPECT_EQ(motion.verdict, Verdict::ok);
  return (motion.twist.velocity_m_s - twist.velocity_m_s).norm() / speed_m_s;
}

TEST(PaperProcedure, FirstOrderMotionFieldErrorIsBelowOnePercent) {
  const double a = speed_error(400, 25, 1152, {0.02, -0.03, 0.05}, 1 / 25.0);
  const double b = speed_error(10, 2, 1800, {0.1, -0.15, 0.2}, 1 / 30.0);
  EXPECT_NEAR(a, 0.0026, 0.0002);
  EXPECT_NEAR(b, 0.0097, 0.0005);
  // error of first order in the frame interval
  EXPECT_NEAR(a / speed_error(400, 25, 1152, {0.02, -0.03, 0.05}, 1 / 50.0), 2, 0.05);
  EXPECT_NEAR(b / speed_error(10, 2, 1800, {0.1, -0.15, 0.2}, 1 / 60.0), 2, 0.05);
}

// The paper's flight: 150 s, 1 km forward, 100 m sideways, 50 m down, up to 2 deg of roll and
// pitch.
RigidTransform flown_pose(double t_s) {
  const double progress = t_s / 150;
  const double ease = progress - std::sin(2 * std::numbers::pi * progress) / (2 * std::numbers::pi);
  return {to_quaternion({.yaw_rad = 0.1 * ease,
                         .pitch_rad = 1.5 * kDegree * std::sin(0.5 * t_s),
                         .roll_rad = 2.0 * kDegree * std::sin(0.3 * t_s)}),
          {1000 * progress, 100 * ease, 400 - 50 * ease}};
}

struct EndError {
  double horizontal_m;
  double height_m;
  double rotation_rad;
};

struct ErrorSource {
  bool nadir = false;  // motion field of earlier work: assumes a nadir camera
  double initial_pitch_error_rad = 0;
};

EndError fly(const ErrorSource& error_source) {
  constexpr double kFrame_s = 1 / 25.0;
  constexpr int kFrames = 3750;
  const RigidTransform body_from_camera{kBodyFromCamera, Eigen::Vector3d::Zero()};
  EgoMotionSolver solver(kPaperCamera, {.weighting = Weighting::plain});
  RigidTransform world_from_body = flown_pose(0);
  world_from_body.rotation =
      world_from_body.rotation * so3_exp({0, error_source.initial_pitch_error_rad, 0});
  AxisEstimates state;
  state.fill({0, 1});
  for (int k = 0; k < kFrames; ++k) {
    const std::vector<FlowVector> vectors =
        exact_flow(kPaperCamera, flown_pose(k * kFrame_s) * body_from_camera,
                   flown_pose((k + 1) * kFrame_s) * body_from_camera);
    RigidTransform world_from_camera = world_from_body * body_from_camera;
    if (error_source.nadir) {
      const double yaw_rad = to_euler(world_from_body.rotation).yaw_rad;
      world_from_camera.rotation = to_quaternion({.yaw_rad = yaw_rad}) * kBodyFromCamera;
    }
    const EgoMotion motion =
        solver.solve(vectors, ground_plane_in_camera(world_from_camera), kFrame_s);
    EXPECT_EQ(motion.verdict, Verdict::ok);
    state = filter_axes({}, state,
                        in_filter_axes(motion.twist, motion.covariance, world_from_camera.rotation),
                        Vector6d::Zero(), kFrame_s);
    const Eigen::Vector3d velocity(state[0].value, state[1].value, state[2].value);
    const Eigen::Vector3d rate(state[3].value, state[4].value, state[5].value);
    world_from_body = integrate_euler(world_from_body, velocity, kBodyFromCamera * rate,
                                      Vector6d::Zero(), kFrame_s);
  }
  const RigidTransform truth = flown_pose(kFrames * kFrame_s);
  const Eigen::Vector3d error = world_from_body.translation - truth.translation;
  return {error.head<2>().norm(), error.z(),
          angle_between_rad(world_from_body.rotation, truth.rotation)};
}

TEST(PaperProcedure, DriftOfPaperFlightIsBelowHalfAMetre) {
  const EndError end = fly({});
  EXPECT_LT(end.horizontal_m, 0.4);
  EXPECT_NEAR(end.height_m, 0, 0.4);
  EXPECT_LT(end.rotation_rad, 0.005 * kDegree);
}

TEST(PaperProcedure, NadirMotionFieldIncreasesDrift) {
  const EndError end = fly({.nadir = true});
  EXPECT_NEAR(end.horizontal_m, 1.4, 0.1);
  EXPECT_NEAR(end.rotation_rad, 0.13 * kDegree, 0.01 * kDegree);
}

TEST(PaperProcedure, InitialTiltErrorIsNotCorrected) {
  const EndError end = fly({.initial_pitch_error_rad = 1 * kDegree});
  EXPECT_NEAR(end.horizontal_m, 28, 1);
  EXPECT_NEAR(end.height_m, -17.3, 0.5);
  EXPECT_NEAR(end.rotation_rad, 0.76 * kDegree, 0.03 * kDegree);
}

}  // namespace
}  // namespace stillkite
