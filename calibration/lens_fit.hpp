#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "calibration/board_view.hpp"
#include "calibration/lens_model.hpp"

namespace stillkite {

/// Lens with the poses of the board that minimize the squared distances between the measured and
/// the projected corners (Zhang, "A flexible new technique for camera calibration", PAMI 2000).
struct LensFit {
  LensModel model;
  Camera camera;
  std::vector<RigidTransform> camera_from_board;        ///< of each view
  std::vector<std::vector<Eigen::Vector2d>> residuals;  ///< px, measured - projected
  std::vector<std::vector<bool>> inliers;
  double corner_sigma_px = 0;  ///< RMS of a component over the inliers, by degrees of freedom
  /// Of the parameters in the order of LensModel, the poses eliminated.
  Eigen::MatrixXd covariance;
};

/// Levenberg-Marquardt from several focal lengths, or from `initial`. Corners beyond four standard
/// deviations are outliers. Empty if no start converges.
[[nodiscard]] std::optional<LensFit> fit_lens(std::span<const BoardView> views,
                                              const LensModel& model, int width_px, int height_px,
                                              const Camera* initial = nullptr);

/// Pose of the board in one view with a known lens.
struct BoardPose {
  RigidTransform camera_from_board;
  double squared_error_px2 = 0;  ///< sum over the corners
};
[[nodiscard]] std::optional<BoardPose> board_pose(const BoardView& view, const LensModel& model,
                                                  const Camera& camera);

/// Information on the lens parameters in one view for corners of sigma 1 px, the pose eliminated.
[[nodiscard]] Eigen::MatrixXd lens_information(const BoardView& view, const LensModel& model,
                                               const Camera& camera,
                                               const RigidTransform& camera_from_board);

/// RMS of a component of the residuals.
[[nodiscard]] double view_rms_px(const std::vector<Eigen::Vector2d>& residuals);

}  // namespace stillkite
