#pragma once

#include <Eigen/Core>
#include <optional>

#include "estimation/sliding_window/window_equations.hpp"

namespace stillkite {

/// Result of `optimize`.
struct WindowFit {
  double cost = 0;          ///< half the sum of squared residuals, robust
  double reprojection = 0;  ///< part of it by the points
  int observations = 0;     ///< of the points, without those of their first keyframes
  int iterations = 0;
  /// Covariance of the newest frame at the last linearization; empty if no step was possible.
  std::optional<Eigen::MatrixXd> newest_covariance;
};

/// Levenberg-Marquardt over all variables and points; Huber's loss on the reprojections.
WindowFit optimize(Window& window, int max_iterations);

/// Newton decrement: decrease of the cost that the linearized equations predict, half the squared
/// distance from the minimum in standard deviations; infinite if they cannot be solved.
[[nodiscard]] double newton_decrement(const Window& window);

/// Standard deviation of a linear combination of the variables' errors; infinite if it is not
/// observable.
[[nodiscard]] double window_sigma(const Window& window, const Eigen::VectorXd& combination);

/// Covariance of all variables; empty if they are not observable.
[[nodiscard]] std::optional<Eigen::MatrixXd> window_covariance(const Window& window);

}  // namespace stillkite
