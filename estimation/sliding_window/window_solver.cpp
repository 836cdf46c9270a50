#include "estimation/sliding_window/window_solver.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <vector>

#include "estimation/robust_kernel.hpp"
#include "estimation/sliding_window/ground_equations.hpp"
#include "estimation/sliding_window/imu_factor.hpp"
#include "estimation/sliding_window/reprojection_errors.hpp"
#include "estimation/sliding_window/window_step.hpp"

namespace stillkite {
namespace {

// Covariance of the newest frame's variables, which are the last: with H = L L^T, of L's last
// block.
Eigen::MatrixXd newest_covariance(const Window& window, const Eigen::LLT<Eigen::MatrixXd>& factor) {
  const Eigen::Index size = window.frames.back().size();
  const Eigen::MatrixXd root = factor.matrixLLT()
                                   .bottomRightCorner(size, size)
                                   .triangularView<Eigen::Lower>()
                                   .solve(Eigen::MatrixXd::Identity(size, size));
  return root.transpose() * root;
}

struct Cost {
  double total = 0;
  double reprojection = 0;
  int observations = 0;
};

Cost cost_of(const Window& window, const WindowScope& scope) {
  Cost cost;
  const Eigen::VectorXd d = error_from_first_estimates(window);
  cost.total += 0.5 * d.dot(window.prior.information * d) - window.prior.gradient.dot(d);
  for (const std::size_t end : scope.imu_frames) {
    const WindowFrame& from = window.frames[end - 1];
    const WindowFrame& to = window.frames[end];
    cost.total += 0.5 * imu_squared_error(to.imu, from.state, to.state);
  }
  for (const std::size_t i : scope.rest_frames) {
    const WindowFrame& frame = window.frames[i];
    cost.total += 0.5 * (frame.state.velocity_in_world_m_s / *frame.rest_sigma_m_s).squaredNorm();
  }
  ReprojectionErrors errors(window);
  GroundViews ground(window, false);
  CameraPairs pairs(window, false);
  cost.total += ground_alignments_cost(window, scope.alignments, pairs, ground);
  for (const std::size_t i : scope.tracks) {
    const WindowTrack& track = window.tracks[i];
    const WindowObservation& host = track.observations.front();
    const Eigen::Vector2d residual = host.bearing - track.point->bearing;
    cost.total += 0.5 * residual.dot(host.information * residual);
    if (track.ground_information > 0) {
      const double height = ground.at(*window.find(host.frame_id)).height_ratio(*track.point);
      cost.total += 0.5 * track.ground_information * height * height;
    }
    for (std::size_t k = 1; k < track.observations.size(); ++k) {
      const double squared = errors.squared(track, track.observations[k]);
      constexpr double kBehindCamera = 1e4;
      cost.reprojection += 0.5 * huber_loss(std::min(squared, kBehindCamera));
      ++cost.observations;
    }
  }
  cost.total += cost.reprojection;
  return cost;
}

// Values of all variables and points, to undo a step.
struct Values {
  CameraExtrinsics extrinsics;
  WindowGround ground;
  std::vector<InertialState> states;
  std::vector<InverseDepthPoint> points;
};

Values values_of(const Window& window, const WindowScope& scope) {
  Values values{window.extrinsics, window.ground, {}, {}};
  values.states.reserve(window.frames.size());
  for (const WindowFrame& frame : window.frames) values.states.push_back(frame.state);
  values.points.reserve(scope.tracks.size());
  for (const std::size_t i : scope.tracks) values.points.push_back(*window.tracks[i].point);
  return values;
}

void restore(const Values& values, const WindowScope& scope, Window& window) {
  window.extrinsics = values.extrinsics;
  window.ground = values.ground;
  for (std::size_t i = 0; i < values.states.size(); ++i) {
    window.frames[i].state = values.states[i];
  }
  for (std::size_t i = 0; i < values.points.size(); ++i) {
    window.tracks[scope.tracks[i]].point = values.points[i];
  }
}

}  // namespace

WindowFit optimize(Window& window, int max_iterations) {
  constexpr double kMinDecrease = 0.02;  // by a step of 0.2 standard deviations
  constexpr double kMinDamping = 1e-6;
  constexpr double kMaxDamping = 1e3;
  const WindowScope scope = whole_window(window);
  Cost cost = cost_of(window, scope);
  double damping = 0;  // Gauss-Newton, unless the cost grows
  WindowFit fit;
  WindowLinearization linear = linearize(window, scope);
  while (fit.iterations < max_iterations && damping < kMaxDamping) {
    ++fit.iterations;
    WindowEquations equations = eliminate_points(linear, damping);
    equations.information.diagonal() *= 1 + damping;
    const Eigen::LLT<Eigen::MatrixXd> factor(equations.information);
    const Eigen::VectorXd step = factor.solve(equations.gradient);
    const bool is_solved = factor.info() == Eigen::Success && step.allFinite();
    const Values before = values_of(window, scope);
    if (is_solved) apply_step(step, linear, window);
    const Cost next = cost_of(window, scope);
    if (!is_solved || !(next.total <= cost.total)) {
      restore(before, scope, window);
      damping = std::max(kMinDamping, 10 * damping);
      continue;
    }
    if (damping == 0) fit.newest_covariance = newest_covariance(window, factor);
    const double decrease = cost.total - next.total;
    cost = next;
    damping = damping > kMinDamping ? 0.1 * damping : 0;
    if (decrease < kMinDecrease) break;
    linear = linearize(window, scope);
  }
  fit.cost = cost.total;
  fit.reprojection = cost.reprojection;
  fit.observations = cost.observations;
  return fit;
}

double newton_decrement(const Window& window) {
  const WindowEquations equations = window_equations(window, whole_window(window));
  const Eigen::LLT<Eigen::MatrixXd> factor(equations.information);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  return 0.5 * equations.gradient.dot(factor.solve(equations.gradient));
}

double window_sigma(const Window& window, const Eigen::VectorXd& combination) {
  const WindowEquations equations = window_equations(window, whole_window(window));
  const Eigen::LLT<Eigen::MatrixXd> factor(equations.information);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  return factor.matrixL().solve(combination).norm();
}

std::optional<Eigen::MatrixXd> window_covariance(const Window& window) {
  const WindowEquations equations = window_equations(window, whole_window(window));
  const Eigen::LLT<Eigen::MatrixXd> factor(equations.information);
  if (factor.info() != Eigen::Success) return std::nullopt;
  return factor.solve(
      Eigen::MatrixXd::Identity(equations.gradient.size(), equations.gradient.size()));
}

}  // namespace stillkite
