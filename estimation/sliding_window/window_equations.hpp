#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "estimation/sliding_window/window.hpp"

namespace stillkite {

/// Part of a window's measurements.
struct WindowScope {
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

/// `window_equations` in two steps, for the values of the points.

/// Normal equations of a point: V d = g - W (poses and extrinsics).
struct PointEquations {
  std::size_t track = 0;
  Eigen::Matrix3d V = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  struct PoseBlock {
    int at;
    Eigen::Matrix<double, 3, InertialIndex::kPoseSize> W;
  };
  std::vector<PoseBlock> poses;
  Eigen::Matrix<double, 3, ExtrinsicsIndex::kSize> by_extrinsics =
      Eigen::Matrix<double, 3, ExtrinsicsIndex::kSize>::Zero();
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  ///< of V, with damping

  Eigen::Matrix<double, 3, InertialIndex::kPoseSize>& pose_block(int at) {
    for (PoseBlock& block : poses) {
      if (block.at == at) return block.W;
    }
    poses.push_back({at, Eigen::Matrix<double, 3, InertialIndex::kPoseSize>::Zero()});
    return poses.back().W;
  }
};

/// Normal equations before the elimination of the points; lower triangle only.
struct WindowLinearization {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  std::vector<PointEquations> points;
};

[[nodiscard]] WindowLinearization linearize(const Window& window, const WindowScope& scope);

/// Lower triangle only. `damping`: relative, of the points' diagonals.
[[nodiscard]] WindowEquations eliminate_points(WindowLinearization& linear, double damping);

/// Normal equations at the present estimate, both triangles.
[[nodiscard]] WindowEquations window_equations(const Window& window, const WindowScope& scope);

/// Error of the present estimate from the first estimates, zero for frames without one.
[[nodiscard]] Eigen::VectorXd error_from_first_estimates(const Window& window);

}  // namespace stillkite
