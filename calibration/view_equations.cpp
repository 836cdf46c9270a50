#include "calibration/view_equations.hpp"

#include <opencv2/calib3d.hpp>

namespace stillkite {

ViewEquations view_equations(const BoardView& view, const std::vector<bool>& inliers,
                             const LensModel& model, const Camera& camera,
                             const RigidTransform& camera_from_board) {
  const int n = model.parameters();
  ViewEquations out;
  out.H_lens.setZero(n, n);
  out.H_lens_pose.setZero(n, 6);
  out.g_lens.setZero(n);
  out.residuals.assign(view.pixels.size(), Eigen::Vector2d::Zero());
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    const Eigen::Vector3d rotated =
        camera_from_board.rotation *
        Eigen::Vector3d(view.corners_m[i].x(), view.corners_m[i].y(), 0);
    const auto at =
        project_with_derivatives(camera, model, rotated + camera_from_board.translation);
    if (!at) {
      out.is_in_front = false;
      return out;
    }
    const Eigen::Vector2d residual = view.pixels[i] - at->pixel;
    out.residuals[i] = residual;
    if (!inliers.empty() && !inliers[i]) continue;
    Eigen::Matrix<double, 2, 6> J;
    J << -at->by_point * skew(rotated), at->by_point;
    out.H_lens += at->by_parameters.transpose() * at->by_parameters;
    out.H_lens_pose += at->by_parameters.transpose() * J;
    out.H_pose += J.transpose() * J;
    out.g_lens += at->by_parameters.transpose() * residual;
    out.g_pose += J.transpose() * residual;
    out.squared_error_px2 += residual.squaredNorm();
  }
  return out;
}

RigidTransform moved_pose(const RigidTransform& pose, const Vector6d& step) {
  return {(so3_exp(step.head<3>()) * pose.rotation).normalized(),
          pose.translation + step.tail<3>()};
}

std::optional<RigidTransform> initial_pose(const BoardView& view, const Camera& camera) {
  std::vector<cv::Point3d> corners;
  std::vector<cv::Point2d> points;
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    const auto point = undistort(camera, view.pixels[i]);
    if (!point) return std::nullopt;
    corners.emplace_back(view.corners_m[i].x(), view.corners_m[i].y(), 0);
    points.emplace_back(point->x(), point->y());
  }
  cv::Vec3d rotation, translation;
  try {
    if (!cv::solvePnP(corners, points, cv::Matx33d::eye(), {}, rotation, translation)) {
      return std::nullopt;
    }
  } catch (const cv::Exception&) {  // corners on one line
    return std::nullopt;
  }
  const RigidTransform pose{so3_exp({rotation[0], rotation[1], rotation[2]}),
                            {translation[0], translation[1], translation[2]}};
  if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) return std::nullopt;
  return pose;
}

}  // namespace stillkite
