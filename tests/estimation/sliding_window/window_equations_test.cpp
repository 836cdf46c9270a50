#include "estimation/sliding_window/window_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "estimation/robust_kernel.hpp"
#include "estimation/sliding_window/reprojection_errors.hpp"
#include "true_window.hpp"

namespace stillkite {
namespace {

// The estimate is moved off the minimum, so that no component vanishes.
Window displaced_window() {
  Window window = true_window();
  window.prior.information.setZero();
  window.prior.gradient.setZero();
  for (WindowFrame& frame : window.frames) {
    InertialError error = InertialError::Zero();
    error.head<6>() << 1e-3, -2e-3, 1e-3, 2e-3, 1e-3, -3e-3;
    frame.state = plus(frame.state, static_cast<double>(frame.id) * error);
  }
  return window;
}

// As above, with a third of the points near a slope below the camera.
Window window_above_ground() {
  Window window = displaced_window();
  window.ground = window.first_ground = {.slope = {0.02, -0.05}, .height_m = -3};
  for (std::size_t i = 0; i < window.tracks.size(); i += 3) {
    window.tracks[i].ground_information = 1e4;
  }
  return window;
}

WindowScope all_tracks(const Window& window) {
  WindowScope scope = whole_window(window);
  scope.imu_frames.clear();
  return scope;
}

// Residuals of all observations in standard deviations, times the square root of their weights.
Eigen::VectorXd residuals(const Window& window, const std::vector<double>& weights) {
  std::vector<double> out;
  CameraPairs pairs(window, false);
  const auto add = [&](const WindowObservation& observation, const Eigen::Vector2d& seen,
                       double weight) {
    const Eigen::Matrix2d root = observation.information.llt().matrixU();
    const Eigen::Vector2d r = std::sqrt(weight) * root * (observation.bearing - seen);
    out.insert(out.end(), {r.x(), r.y()});
  };
  GroundViews ground(window, false);
  std::size_t next = 0;
  for (const WindowTrack& track : window.tracks) {
    const std::size_t host = *window.find(track.observations.front().frame_id);
    out.push_back(-std::sqrt(track.ground_information) *
                  ground.at(host).height_ratio(*track.point));
    add(track.observations.front(), track.point->bearing, 1);
    for (std::size_t k = 1; k < track.observations.size(); ++k) {
      const std::size_t target = *window.find(track.observations[k].frame_id);
      add(track.observations[k], *project_bearing(pairs.at(host, target), *track.point),
          weights[next++]);
    }
  }
  return Eigen::Map<Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

std::vector<double> huber_weights(const Window& window) {
  std::vector<double> weights;
  ReprojectionErrors errors(window);
  for (const WindowTrack& track : window.tracks) {
    for (std::size_t k = 1; k < track.observations.size(); ++k) {
      const double squared = errors.squared(track, track.observations[k]);
      weights.push_back(robust_weight(RobustKernel::huber, squared).weight);
    }
  }
  return weights;
}

// The window with one variable changed; those of the points follow the others.
Window changed(const Window& window, int variable, double step) {
  Window out = window;
  const std::vector<int> offsets = window.offsets();
  if (variable < ExtrinsicsIndex::kSize) {
    out.extrinsics = plus(out.extrinsics, step * ExtrinsicsError::Unit(variable));
  } else if (variable < SharedIndex::kSize) {
    out.ground = plus(out.ground, step * GroundError::Unit(variable - SharedIndex::kGround));
  } else if (variable < offsets.back()) {
    std::size_t frame = window.frames.size() - 1;
    while (variable < offsets[frame]) --frame;
    InertialState& state = out.frames[frame].state;
    state = plus(state, step * InertialError::Unit(variable - offsets[frame]));
  } else {
    const int of_points = variable - offsets.back();
    InverseDepthPoint& point = *out.tracks[static_cast<std::size_t>(of_points / 3)].point;
    if (of_points % 3 < 2) point.bearing[of_points % 3] += step;
    if (of_points % 3 == 2) point.inverse_depth += step;
  }
  return out;
}

void expect_equations_of_numeric_jacobians(const Window& window) {
  const std::vector<double> weights = huber_weights(window);
  ASSERT_LT(*std::min_element(weights.begin(), weights.end()), 0.9);
  const int kept = window.offsets().back();
  const int size = kept + 3 * static_cast<int>(window.tracks.size());
  const Eigen::VectorXd r = residuals(window, weights);
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd J(r.size(), size);
  for (int i = 0; i < size; ++i) {
    J.col(i) = (residuals(changed(window, i, -kStep), weights) -
                residuals(changed(window, i, kStep), weights)) /
               (2 * kStep);
  }
  const Eigen::MatrixXd H = J.transpose() * J;
  const Eigen::VectorXd g = J.transpose() * r;
  const int points = size - kept;
  const Eigen::MatrixXd by_points =
      H.topRightCorner(kept, points) * H.bottomRightCorner(points, points).inverse();
  const Eigen::MatrixXd expected_H =
      H.topLeftCorner(kept, kept) - by_points * H.bottomLeftCorner(points, kept);
  const Eigen::VectorXd expected_g = g.head(kept) - by_points * g.tail(points);

  const WindowEquations equations = window_equations(window, all_tracks(window));
  // relative to the variables' own information
  const Eigen::VectorXd unit = H.diagonal().head(kept).cwiseMax(1).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd H_difference =
      unit.asDiagonal() * (equations.information - expected_H) * unit.asDiagonal();
  EXPECT_LT(H_difference.cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(unit.cwiseProduct(equations.gradient - expected_g).cwiseAbs().maxCoeff(),
            1e-5 * r.norm());
}

TEST(WindowEquations, AreTheSchurComplementOfNumericJacobians) {
  expect_equations_of_numeric_jacobians(displaced_window());
}

TEST(WindowEquations, OfPointsOnTheGroundAreThoseOfNumericJacobians) {
  expect_equations_of_numeric_jacobians(window_above_ground());
}

TEST(WindowEquations, ErrorsOfPairsAreThoseOfThePoses) {
  const Window window = displaced_window();
  const WindowLinearization linear = linearize(window, all_tracks(window));
  ASSERT_EQ(linear.hosts.size(), 2U);
  const int moved = window.offsets()[3];
  Eigen::VectorXd error = Eigen::VectorXd::Zero(window.offsets().back());
  error[moved] = 1e-3;
  for (const HostEquations& host : linear.hosts) {
    const std::vector<PairError> errors = pair_errors(host, linear.offsets, error);
    for (std::size_t i = 0; i < host.pairs.size(); ++i) {
      EXPECT_EQ(errors[i].norm() > 0, host.pairs[i].target == 3) << host.pairs[i].target;
    }
  }
}

}  // namespace
}  // namespace stillkite
