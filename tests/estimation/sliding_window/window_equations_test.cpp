#include "estimation/sliding_window/window_equations.hpp"

#include <gtest/gtest.h>

#include "estimation/robust_kernel.hpp"
#include "estimation/sliding_window/reprojection_errors.hpp"
#include "true_window.hpp"

namespace stillkite {
namespace {

WindowScope all_tracks(const Window& window) {
  WindowScope scope = whole_window(window);
  scope.imu_frames.clear();
  return scope;
}

double reprojection_cost(const Window& window) {
  double cost = 0;
  ReprojectionErrors errors(window);
  for (const WindowTrack& track : window.tracks) {
    for (std::size_t k = 1; k < track.observations.size(); ++k) {
      cost += 0.5 * huber_loss(errors.squared(track, track.observations[k]));
    }
  }
  return cost;
}

// Minus the derivative of the cost with respect to a change of the window.
template <typename Change>
double numeric_gradient(const Window& window, const Change& change) {
  constexpr double kStep = 1e-6;
  Window forward = window, backward = window;
  change(forward, kStep);
  change(backward, -kStep);
  return (reprojection_cost(backward) - reprojection_cost(forward)) / (2 * kStep);
}

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

TEST(WindowEquations, GradientOfTheExtrinsicsAgreesWithDifferences) {
  const Window window = displaced_window();
  const WindowLinearization linear = linearize(window, all_tracks(window));
  for (int i = 0; i < ExtrinsicsIndex::kSize; ++i) {
    const double expected = numeric_gradient(window, [&](Window& moved, double step) {
      moved.extrinsics = plus(moved.extrinsics, step * ExtrinsicsError::Unit(i));
    });
    EXPECT_NEAR(linear.g(i), expected, 1e-3 * std::abs(expected) + 1e-3) << "variable " << i;
  }
}

TEST(WindowEquations, GradientOfThePosesAgreesWithDifferences) {
  const Window window = displaced_window();
  const WindowLinearization linear = linearize(window, all_tracks(window));
  const std::vector<int> offsets = window.offsets();
  for (std::size_t k = 0; k < window.frames.size(); ++k) {
    for (int i = 0; i < InertialIndex::kPoseSize; ++i) {
      const double expected = numeric_gradient(window, [&](Window& moved, double step) {
        InertialState& state = moved.frames[k].state;
        state = plus(state, step * InertialError::Unit(i));
      });
      EXPECT_NEAR(linear.g(offsets[k] + i), expected, 1e-3 * std::abs(expected) + 1e-3)
          << "frame " << k << ", variable " << i;
    }
  }
}

}  // namespace
}  // namespace stillkite
