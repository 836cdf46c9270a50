#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "estimation/sliding_window/pair_equations.hpp"
#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Part of a window's measurements.
struct WindowScope {
  std::vector<std::size_t> tracks;       ///< with a point; indices in Window::tracks
  std::vector<std::size_t> imu_frames;   ///< frames whose IMU factor from the previous one counts
  std::vector<std::size_t> rest_frames;  ///< frames whose zero velocity counts
  std::vector<std::size_t> alignments;   ///< indices in Window::alignments
  std::int64_t excluded_frame_id = -1;   ///< its observations do not count
};

/// All triangulated tracks, IMU factors, ground alignments and the prior.
[[nodiscard]] WindowScope whole_window(const Window& window);

/// Normal equations H d = g of the window's variables, the points eliminated (bundle adjustment:
/// Triggs et al. 2000, section 6.1).
struct WindowEquations {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

/// `window_equations` in two steps, for the values of the points. Residuals depend on the variables
/// by the errors of the camera pairs only: equations are summed up by pair, for each host, and
/// expressed by the window's variables afterwards.

/// Normal equations of a point: V d = g - W (errors of its pairs).
struct PointEquations {
  std::size_t track = 0;
  Eigen::Matrix3d V = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  std::size_t first_view = 0;  ///< in HostEquations::views
  std::size_t views = 0;
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  ///< of V, with damping
};

/// View of a point in the other image of a pair.
struct PointView {
  std::size_t pair = 0;
  Eigen::Matrix<double, 3, 6> W;
};

/// Equations of all points of one first keyframe.
struct HostEquations {
  std::size_t host = 0;  ///< frame
  std::vector<PairEquations> pairs;
  std::vector<PointEquations> points;
  std::vector<PointView> views;
};

/// Normal equations before the elimination of the points. `H`, `g`: of prior, IMU, rest and ground
/// alignments; lower triangle only.
struct WindowLinearization {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  std::vector<HostEquations> hosts;
  std::vector<int> offsets;  ///< of the window
};

[[nodiscard]] WindowLinearization linearize(const Window& window, const WindowScope& scope);

/// Lower triangle only. `damping`: relative, of the points' diagonals.
[[nodiscard]] WindowEquations eliminate_points(WindowLinearization& linear, double damping);

/// Errors of the pairs of a host by those of the window's variables.
[[nodiscard]] std::vector<PairError> pair_errors(const HostEquations& host,
                                                 const std::vector<int>& offsets,
                                                 const Eigen::VectorXd& error);

/// Normal equations at the present estimate, both triangles.
[[nodiscard]] WindowEquations window_equations(const Window& window, const WindowScope& scope);

/// Error of the present estimate from the first estimates, zero for frames without one.
[[nodiscard]] Eigen::VectorXd error_from_first_estimates(const Window& window);

}  // namespace stillkite
