#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibration/board_view.hpp"
#include "calibration/lens_model.hpp"

namespace stillkite {

/// Gauss-Newton equations of one view. Error of the pose: x = exp(w) R X + t + dt, (w, dt).
struct ViewEquations {
  Eigen::MatrixXd H_lens;
  Eigen::Matrix<double, Eigen::Dynamic, 6> H_lens_pose;
  Matrix6d H_pose = Matrix6d::Zero();
  Eigen::VectorXd g_lens;
  Vector6d g_pose = Vector6d::Zero();
  double squared_error_px2 = 0;
  std::vector<Eigen::Vector2d> residuals;
  bool is_in_front = true;  ///< all corners are
};

/// `inliers`: empty: all.
[[nodiscard]] ViewEquations view_equations(const BoardView& view, const std::vector<bool>& inliers,
                                           const LensModel& model, const Camera& camera,
                                           const RigidTransform& camera_from_board);

/// Pose of the board after the step (w, dt).
[[nodiscard]] RigidTransform moved_pose(const RigidTransform& pose, const Vector6d& step);

/// Pose from the homography of the undistorted corners; empty where the lens is not invertible.
[[nodiscard]] std::optional<RigidTransform> initial_pose(const BoardView& view,
                                                         const Camera& camera);

}  // namespace stillkite
