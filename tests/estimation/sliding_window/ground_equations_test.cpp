#include "estimation/sliding_window/ground_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <vector>

#include "estimation/sliding_window/window_step.hpp"
#include "true_window.hpp"

namespace stillkite {
namespace {

const WindowGround kSlope{.slope = {0.05, -0.1}, .height_m = -4};

// What a perfect alignment of two frames over the ground measures.
GroundAlignment true_alignment(const Window& window, std::size_t keyframe, std::size_t frame) {
  const CameraPair pair = CameraPairs(window, false).at(keyframe, frame);
  const GroundView ground = GroundViews(window, false).at(keyframe);
  KeyframeView view;
  view.motion = {.rotation = Eigen::Quaterniond(pair.camera_from_host),
                 .translation = pair.baseline_m * ground.normal.norm() / ground.height_m,
                 .normal = -ground.normal.normalized()};
  view.tilt_axes << 1, 0.1, 0, 1, 0.2, 0;
  Vector6d sigma;
  sigma << 1e-3, 2e-3, 1e-3, 5e-4, 4e-4, 3e-4;
  view.measured.covariance = sigma.cwiseAbs2().asDiagonal();
  view.measured.covariance(0, 4) = view.measured.covariance(4, 0) = 2e-7;
  view.measured.motion_by_tilt << 0.1, 0, 0, 0.2, 0.1, 0.1, -0.3, 0, 0, 0.2, 0.1, 0.1;
  view.measured.tilt_information << 1e4, 2e3, 2e3, 2e4;
  return ground_alignment(view, window.frames[keyframe].id, window.frames[frame].id);
}

// Ground keyframe: frame 0, the others aligned to it.
Window window_over_ground() {
  Window window = true_window();
  window.prior.information.setZero();
  window.prior.gradient.setZero();
  window.ground = window.first_ground = kSlope;
  window.start.emplace(StartAboveGround{.relief = GroundRelief(4)});
  for (std::size_t i = 1; i < 4; ++i) window.alignments.push_back(true_alignment(window, 0, i));
  return window;
}

WindowScope alignments_of(const Window& window) {
  WindowScope scope;
  scope.alignments = whole_window(window).alignments;
  return scope;
}

double cost_of_alignments(const Window& window) {
  CameraPairs pairs(window, false);
  GroundViews ground(window, false);
  return ground_alignments_cost(window, alignments_of(window).alignments, pairs, ground);
}

Window displaced(const Window& window, const Eigen::VectorXd& error) {
  Window out = window;
  const std::vector<int> offsets = window.offsets();
  out.extrinsics = plus(window.extrinsics, error.head<ExtrinsicsIndex::kSize>());
  out.ground = plus(window.ground, error.segment<3>(SharedIndex::kGround).eval());
  for (std::size_t i = 0; i < out.frames.size(); ++i) {
    InertialError e = InertialError::Zero();
    e.head(out.frames[i].size()) = error.segment(offsets[i], out.frames[i].size());
    out.frames[i].state = plus(out.frames[i].state, e);
  }
  return out;
}

TEST(GroundEquations, CostIsZeroAtTheTruth) {
  EXPECT_NEAR(cost_of_alignments(window_over_ground()), 0, 1e-12);
}

TEST(GroundEquations, InformationIsTheCurvatureOfTheCost) {
  const Window window = window_over_ground();
  const WindowEquations equations = window_equations(window, alignments_of(window));
  EXPECT_LT(equations.gradient.norm(), 1e-6);
  for (int seed = 1; seed <= 20; ++seed) {
    std::srand(static_cast<unsigned>(seed));
    const Eigen::VectorXd d = 1e-5 * Eigen::VectorXd::Random(equations.gradient.size());
    const double expected = 0.5 * d.dot(equations.information * d);
    EXPECT_NEAR(cost_of_alignments(displaced(window, d)) / expected, 1, 2e-3) << seed;
  }
}

TEST(GroundEquations, GradientIsTheSlopeOfTheCost) {
  Window window = window_over_ground();
  std::srand(7);
  window = displaced(window, 2e-4 * Eigen::VectorXd::Random(window.offsets().back()));
  window.first_ground = window.ground;
  window.first_extrinsics = window.extrinsics;
  for (GroundAlignment& alignment : window.alignments) {
    alignment.tilt_information_rad = {3, -2};
  }
  const WindowEquations equations = window_equations(window, alignments_of(window));
  for (Eigen::Index i = 0; i < equations.gradient.size(); ++i) {
    constexpr double kStep = 1e-6;
    const Eigen::VectorXd d = kStep * Eigen::VectorXd::Unit(equations.gradient.size(), i);
    const double slope =
        (cost_of_alignments(displaced(window, d)) - cost_of_alignments(displaced(window, -d))) /
        (2 * kStep);
    EXPECT_NEAR(-equations.gradient[i], slope, 2e-3 * equations.gradient.cwiseAbs().maxCoeff())
        << i;
  }
}

// Linearized at other positions and another height, they still measure ratios of lengths only.
TEST(GroundEquations, LinearizationPointDoesNotMeasureScale) {
  Window window = window_over_ground();
  const auto camera = [&](std::size_t frame) {
    return (window.frames[frame].state.world_from_imu * window.extrinsics.imu_from_camera)
        .translation;
  };
  const std::vector<int> offsets = window.offsets();
  Eigen::VectorXd height = Eigen::VectorXd::Zero(offsets.back());
  height[SharedIndex::kGround + GroundIndex::kHeight] = -GroundViews(window, false).at(0).height_m;
  Eigen::VectorXd scale = height;
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    scale.segment<3>(offsets[i] + InertialIndex::kPosition) = camera(i) - camera(0);
  }
  window.first_ground.height_m *= 1.05;
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    window.frames[i].first_estimate = window.frames[i].state;
    window.frames[i].first_estimate->world_from_imu.translation += Eigen::Vector3d(0.1, -0.2, 0.1);
  }
  const Eigen::MatrixXd H = window_equations(window, alignments_of(window)).information;
  EXPECT_LT(scale.dot(H * scale), 1e-9 * height.dot(H * height));
}

// Errors of one keyframe's image are in all its alignments: any number of them leaves half of the
// variance of one.
TEST(GroundEquations, NoiseOfTheKeyframeDoesNotAverageOut) {
  Window window = window_over_ground();
  window.start.reset();  // no relief
  GroundAlignment alignment = window.alignments.front();
  alignment.tilt_information.setZero();
  const auto information = [&](std::size_t count) {
    window.alignments.assign(count, alignment);
    const WindowEquations equations = window_equations(window, alignments_of(window));
    const int keyframe = window.offsets()[*window.find(alignment.keyframe_id)];
    return equations.information.block<6, 6>(keyframe, keyframe).trace();
  };
  const double one = information(1);
  EXPECT_NEAR(information(100) / one, 2 / (1 + 1.0 / 100), 1e-6);
}

}  // namespace
}  // namespace stillkite
