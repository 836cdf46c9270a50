#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Camera pairs of a window, each computed once; at the present estimate or at the linearization
/// points.
class CameraPairs {
 public:
  CameraPairs(const Window& window, bool at_first_estimates)
      : window_(window),
        at_first_estimates_(at_first_estimates),
        pairs_(window.frames.size() * window.frames.size()) {}

  [[nodiscard]] const CameraPair& at(std::size_t host, std::size_t target);

 private:
  const Window& window_;
  bool at_first_estimates_;
  std::vector<std::optional<CameraPair>> pairs_;
};

/// Part of a window's measurements.
struct WindowScope {
  bool prior = true;
  std::vector<std::size_t> tracks;       ///< with a point; indices in Window::tracks
  std::vector<std::size_t> imu_frames;   ///< frames whose IMU factor from the previous one counts
  std::vector<std::size_t> rest_frames;  ///< frames whose zero velocity counts
  std::int64_t excluded_frame_id = -1;   ///< its observations do not count
};

/// All triangulated tracks, all IMU factors and the prior.
[[nodiscard]] WindowScope whole_window(const Window& window);

/// Normal equations H d = g of the window's variables, the points eliminated (bundle adjustment:
/// Triggs et al. 2000, section 6.1).
struct WindowEquations {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};
[[nodiscard]] WindowEquations window_equations(const Window& window, const WindowScope& scope);

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

/// Squared reprojection errors over their variances.
class ReprojectionErrors {
 public:
  explicit ReprojectionErrors(const Window& window) : window_(window), pairs_(window, false) {}

  /// Infinite behind the camera.
  [[nodiscard]] double squared(const WindowTrack& track, const WindowObservation& observation);

 private:
  const Window& window_;
  CameraPairs pairs_;
};

/// Newton decrement: decrease of the cost that the linearized equations predict, half the squared
/// distance from the minimum in standard deviations; infinite if they cannot be solved.
[[nodiscard]] double newton_decrement(const Window& window);

/// Covariance of all variables; empty if they are not observable.
[[nodiscard]] std::optional<Eigen::MatrixXd> window_covariance(const Window& window);

}  // namespace stillkite
