#include "estimation/fusion/landmark_model.hpp"

#include <gtest/gtest.h>

#include <random>
#include <utility>

namespace stillkite {
namespace {

std::pair<FusionState, Landmark> off_by(FusionState state, Landmark landmark,
                                        const Eigen::VectorXd& error) {
  using Index = FusionIndex;
  const auto turn = [&](RigidTransform& pose, int rotation, int position) {
    pose.rotation = so3_exp(error.segment<3>(rotation)) * pose.rotation;
    pose.translation += error.segment<3>(position);
  };
  turn(state.world_from_camera, Index::kRotation, Index::kPosition);
  turn(state.world_from_anchor, Index::kAnchorRotation, Index::kAnchorPosition);
  landmark.bearing += error.segment<2>(Index::kLandmarks);
  landmark.inverse_depth += error[Index::kLandmarks + 2];
  return {state, landmark};
}

Eigen::Vector2d predicted_view(const FusionState& at, const Landmark& of,
                               const Eigen::VectorXd& error) {
  const auto& [state, landmark] = off_by(at, of, error);
  return -landmark_innovation(state, landmark, FusionIndex::kLandmarks, Eigen::Vector2d::Zero(),
                              Eigen::Matrix2d::Identity())
              ->residual;
}

TEST(LandmarkModel, JacobianIsTheNumericOne) {
  FusionState state;
  state.world_from_camera = {so3_exp({0.2, -0.1, 0.3}), {0.4, -0.2, 0.1}};
  state.world_from_anchor = {so3_exp({-0.1, 0.2, 0.1}), {-0.1, 0.3, 0.2}};
  const Landmark landmark{.feature = 1, .bearing = {0.3, -0.2}, .inverse_depth = 0.4};
  const int n = FusionIndex::kLandmarks + 3;
  const Eigen::MatrixXd H = landmark_innovation(state, landmark, FusionIndex::kLandmarks, {0, 0},
                                                Eigen::Matrix2d::Identity())
                                ->H.times(Eigen::MatrixXd::Identity(n, n));
  constexpr double kStep = 1e-6;
  for (int i = 0; i < n; ++i) {
    const Eigen::VectorXd error = kStep * Eigen::VectorXd::Unit(n, i);
    const Eigen::Vector2d numeric =
        (predicted_view(state, landmark, error) - predicted_view(state, landmark, -error)) /
        (2 * kStep);
    EXPECT_LT((numeric - H.col(i)).norm(), 1e-8) << "column " << i;
  }
}

TEST(LandmarkModel, SeenFromTheCameraItIsTheSamePointAndItsJacobianTheNumericOne) {
  FusionState state;
  state.world_from_camera = {so3_exp({0.2, -0.1, 0.3}), {0.4, -0.2, 0.1}};
  state.world_from_anchor = {so3_exp({-0.1, 0.2, 0.1}), {-0.1, 0.3, 0.2}};
  const Landmark landmark{.feature = 1, .bearing = {0.3, -0.2}, .inverse_depth = 0.4};
  const auto seen = landmark_from_camera(state, landmark, FusionIndex::kLandmarks);
  ASSERT_TRUE(seen);
  const Eigen::Vector3d place =
      state.world_from_anchor * (landmark.bearing.homogeneous() / landmark.inverse_depth);
  const Eigen::Vector3d again =
      state.world_from_camera * (seen->bearing.homogeneous() / seen->inverse_depth);
  EXPECT_LT((again - place).norm(), 1e-12);
  const int n = FusionIndex::kLandmarks + 3;
  const Eigen::RowVectorXd J = seen->by_error.times(Eigen::MatrixXd::Identity(n, n));
  const auto inverse_depth = [&](const Eigen::VectorXd& error) {
    const auto& [moved, off] = off_by(state, landmark, error);
    return landmark_from_camera(moved, off, FusionIndex::kLandmarks)->inverse_depth;
  };
  constexpr double kStep = 1e-6;
  for (int i = 0; i < n; ++i) {
    const Eigen::VectorXd error = kStep * Eigen::VectorXd::Unit(n, i);
    EXPECT_NEAR((inverse_depth(error) - inverse_depth(-error)) / (2 * kStep), J[i], 1e-8) << i;
  }
}

// A point at infinity tells rotation alone.
TEST(LandmarkModel, InfinityDoesNotMove) {
  FusionState state;
  state.world_from_camera.translation = {3, 2, 1};
  const Landmark landmark{.feature = 1, .bearing = {0.1, 0.2}, .inverse_depth = 0};
  const auto innovation = landmark_innovation(state, landmark, FusionIndex::kLandmarks, {0.1, 0.2},
                                              Eigen::Matrix2d::Identity());
  ASSERT_TRUE(innovation);
  EXPECT_LT(innovation->residual.norm(), 1e-15);
}

// The way's error times the depth's, each drawn a thousand times, is what the linear step leaves
// out.
TEST(LandmarkModel, ProductOfErrorsHasTheCovarianceItSays) {
  FusionState state;
  state.world_from_camera = {so3_exp({0.1, -0.2, 0.3}), {0.1, 0.2, 0.05}};
  const Landmark landmark{.feature = 1, .bearing = {0.3, -0.2}, .inverse_depth = 0.3};
  Eigen::Matrix3d root;
  root << 0.02, 0, 0, 0.005, 0.01, 0, 0, 0.003, 0.03;
  constexpr double kDepthSigma = 0.1;
  const auto view = [&](const Eigen::Vector3d& way, double depth) {
    FusionState moved = state;
    moved.world_from_camera.translation -= way;
    Landmark off = landmark;
    off.inverse_depth += depth;
    const auto seen = landmark_innovation(moved, off, FusionIndex::kLandmarks, {0, 0},
                                          Eigen::Matrix2d::Identity());
    return Eigen::Vector2d(-seen->residual);
  };
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal;
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  constexpr int kDraws = 4000;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector3d way =
        root * Eigen::Vector3d(normal(engine), normal(engine), normal(engine));
    const double depth = kDepthSigma * normal(engine);
    const Eigen::Vector2d left_out =
        view(way, depth) - view(way, 0) - view({0, 0, 0}, depth) + view({0, 0, 0}, 0);
    sum += left_out * left_out.transpose() / kDraws;
  }
  const Eigen::Matrix2d said =
      product_covariance(state, landmark, root * root.transpose(), kDepthSigma * kDepthSigma);
  EXPECT_LT((sum - said).norm(), 0.1 * said.norm());
}

TEST(LandmarkModel, BehindTheCameraIsNoView) {
  FusionState state;
  state.world_from_camera.translation = {0, 0, 20};
  const Landmark landmark{.feature = 1, .bearing = {0, 0}, .inverse_depth = 0.1};
  EXPECT_FALSE(landmark_innovation(state, landmark, FusionIndex::kLandmarks, {0, 0},
                                   Eigen::Matrix2d::Identity()));
}

}  // namespace
}  // namespace stillkite
