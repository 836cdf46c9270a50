#include "estimation/fusion/known_landmark.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <vector>

#include "estimation/fusion/error_state.hpp"

namespace stillkite {
namespace {

// Camera z axis down, x axis along the world's x.
RigidTransform looking_down(double height_m) {
  return {Eigen::Quaterniond(0, 1, 0, 0), {0, 0, height_m}};
}

RigidTransform tilted_camera() {
  return {so3_exp({0.02, -0.03, 0.4}) * looking_down(1).rotation, {20, -30, 395}};
}

Eigen::Vector2d bearing_to(const RigidTransform& world_from_camera,
                           const Eigen::Vector3d& landmark_in_world_m) {
  return (world_from_camera.inverse() * landmark_in_world_m).hnormalized();
}

// Errors of rotation and position in world axes.
RigidTransform with_error(const RigidTransform& pose, const Vector6d& error) {
  return {so3_exp(error.head<3>()) * pose.rotation, pose.translation + error.tail<3>()};
}

TEST(KnownLandmark, ResidualOfALandmarkBelowIsItsOffsetOverTheHeight) {
  const auto view = known_landmark_view(looking_down(400), {8, -12, 0}, {0.021, 0.03});
  ASSERT_TRUE(view);
  EXPECT_NEAR(view->residual.x(), 0.001, 1e-15);  // h = (8, 12) / 400
  EXPECT_NEAR(view->residual.y(), 0, 1e-15);
}

TEST(KnownLandmark, JacobianIsTheNumericOne) {
  const Eigen::Vector3d landmark(60, -120, 5);
  const auto view = known_landmark_view(tilted_camera(), landmark, {0, 0});
  ASSERT_TRUE(view);
  const auto predicted = [&](const Vector6d& pose_error, const Eigen::Vector3d& landmark_error) {
    return bearing_to(with_error(tilted_camera(), pose_error), landmark + landmark_error);
  };
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 6; ++i) {
    const Vector6d error = kStep * Vector6d::Unit(i);
    const Eigen::Vector2d numeric =
        (predicted(error, {0, 0, 0}) - predicted(-error, {0, 0, 0})) / (2 * kStep);
    EXPECT_LT((numeric - view->by_pose.col(i)).norm(), 1e-8) << "pose " << i;
  }
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d error = kStep * Eigen::Vector3d::Unit(i);
    const Eigen::Vector2d numeric =
        (predicted(Vector6d::Zero(), error) - predicted(Vector6d::Zero(), -error)) / (2 * kStep);
    EXPECT_LT((numeric - view->by_landmark.col(i)).norm(), 1e-8) << "landmark " << i;
  }
}

// Initial error of a degree and of metres: a single linear step leaves more than the bounds.
TEST(KnownLandmark, ExactBearingsToExactLandmarksGiveTheExactPose) {
  Vector6d initial_error;
  initial_error << 0.015, -0.01, 0.02, 3, -2, 4;
  RigidTransform pose = with_error(tilted_camera(), initial_error);
  for (int iteration = 0; iteration < 6; ++iteration) {
    Matrix6d N = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d landmark(120.0 * (i / 5) - 180, 120.0 * (i % 5) - 240, i % 7);
      const auto view = known_landmark_view(pose, landmark, bearing_to(tilted_camera(), landmark));
      ASSERT_TRUE(view);
      N += view->by_pose.transpose() * view->by_pose;
      b += view->by_pose.transpose() * view->residual;
    }
    pose = with_error(pose, N.ldlt().solve(b));
  }
  EXPECT_LT((pose.translation - tilted_camera().translation).norm(), 1e-9);
  EXPECT_LT(angle_between_rad(pose.rotation, tilted_camera().rotation), 1e-11);
}

// One landmark below a camera of known attitude, map error s, bearing variance r, n views:
// P = 1 / (1/P_0 + 1/(s^2 + h^2 r / n)). The map's metre stays, however often it is viewed.
TEST(KnownLandmark, ErrorOfTheMapDoesNotAverageOut) {
  constexpr double kHeight_m = 400, kBearingSigma = 1 / 1152.77, kMapSigma_m = 1, kPrior_m = 100;
  const auto view = known_landmark_view(looking_down(kHeight_m), {0, 0, 0}, {0, 0});
  ASSERT_TRUE(view);
  Eigen::Matrix<double, 2, 4> H;  // horizontal position of the camera, of the landmark
  H << view->by_pose.middleCols<2>(3), view->by_landmark.leftCols<2>();
  for (const double n : {1.0, 10.0, 1000.0}) {
    Eigen::Matrix4d information = n / square(kBearingSigma) * H.transpose() * H;
    information.diagonal().head<2>().array() += 1 / square(kPrior_m);
    information.diagonal().tail<2>().array() += 1 / square(kMapSigma_m);
    const Eigen::Matrix4d P = information.ldlt().solve(Eigen::Matrix4d::Identity());
    const double of_view = square(kMapSigma_m) + square(kHeight_m * kBearingSigma) / n;
    EXPECT_NEAR(P(0, 0), 1 / (1 / square(kPrior_m) + 1 / of_view), 1e-6) << n;
    EXPECT_NEAR(P(1, 1), P(0, 0), 1e-9) << n;
  }
}

TEST(KnownLandmark, NoViewOfALandmarkBehindTheCamera) {
  EXPECT_FALSE(known_landmark_view(looking_down(400), {0, 0, 401}, {0, 0}));
}

}  // namespace
}  // namespace stillkite
