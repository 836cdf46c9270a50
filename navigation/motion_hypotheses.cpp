#include "navigation/motion_hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/plane.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

// Limit of the view's rotation: near the horizon few pixels contribute.
constexpr double kMaxTilt_rad = 0.9;

Eigen::Vector2d centre_px(const Camera& camera) {
  return {0.5 * (camera.width_px - 1), 0.5 * (camera.height_px - 1)};
}

}  // namespace

double prediction_sigma_px(const Camera& camera, const MultipleModelFilter& filter) {
  // X = (0, 0, depth) moves by X x w - p for pose errors p, w in camera axes
  const double inverse_depth_1_m =
      std::max(0.0, inverse_depth(ground_plane_in_camera(filter.pose()), {0, 0}));
  Eigen::Matrix<double, 2, 6> J = Eigen::Matrix<double, 2, 6>::Zero();
  J.row(0) << -inverse_depth_1_m, 0, 0, 0, -1, 0;
  J.row(1) << 0, -inverse_depth_1_m, 0, 1, 0, 0;
  J.row(0) *= camera.focal_x_px;
  J.row(1) *= camera.focal_y_px;
  const Eigen::Matrix3d R = filter.pose().rotation.conjugate().toRotationMatrix();
  Matrix6d camera_from_world = Matrix6d::Zero();
  camera_from_world.topLeftCorner<3, 3>() = R;
  camera_from_world.bottomRightCorner<3, 3>() = R;
  J *= camera_from_world;
  return std::sqrt((J * filter.pose_covariance() * J.transpose()).trace());
}

NadirView nadir_view(const Camera& camera, const Eigen::Vector3d& normal) {
  const Eigen::AngleAxisd levelling(rotation_between(normal, Eigen::Vector3d::UnitZ()));
  NadirView out;
  out.view_from_camera =
      Eigen::AngleAxisd(std::min(levelling.angle(), kMaxTilt_rad), levelling.axis());
  Eigen::Matrix3d K;
  K << camera.focal_x_px, 0, camera.centre_x_px, 0, camera.focal_y_px, camera.centre_y_px, 0, 0, 1;
  const Eigen::Vector3d centre = centre_px(camera).homogeneous();
  const Eigen::Vector3d axis = out.view_from_camera * K.inverse() * centre;
  // keep the image scale at the centre
  out.K = K;
  out.K.topLeftCorner<2, 2>() *= axis.z();
  out.K.topRightCorner<2, 1>().setZero();
  out.K.topRightCorner<2, 1>() = (centre - out.K * (axis / axis.z())).head<2>();
  out.homography = out.K * out.view_from_camera.toRotationMatrix() * K.inverse();
  return out;
}

std::vector<PlaneMotion> motion_hypotheses(const ImageRegistration& registration,
                                           const Camera& camera, const NadirView& view,
                                           const Eigen::Vector3d& normal) {
  const Eigen::Matrix3d K_inverse = view.K.inverse();
  const Eigen::Vector3d b = K_inverse * centre_px(camera).homogeneous();
  const Eigen::Vector3d b_now =
      K_inverse * (centre_px(camera) + registration.shift_px).homogeneous();
  const Eigen::Vector3d n = view.view_from_camera * normal;
  const Eigen::Quaterniond camera_from_view = view.view_from_camera.conjugate();
  const auto in_camera = [&](const Eigen::Quaterniond& rotation,
                             const Eigen::Vector3d& translation) {
    return PlaneMotion{.rotation = camera_from_view * rotation * view.view_from_camera,
                       .translation = camera_from_view * translation,
                       .normal = normal};
  };
  std::vector<PlaneMotion> out;
  const double rho = n.dot(b);
  const double rho_now = n.dot(b_now);
  if (rho > 0 && rho_now > 0) {
    // rho t = lambda b' - R b with n . t = 0
    const Eigen::Quaterniond rotation = so3_exp(registration.rotation_rad * n);
    out.push_back(in_camera(rotation, b_now / rho_now - rotation * b / rho));
  }
  const Eigen::Quaterniond shift_rotation = rotation_between(b, b_now);
  out.push_back(
      in_camera(shift_rotation * so3_exp(registration.rotation_rad * b.normalized()), {0, 0, 0}));
  return out;
}

}  // namespace stillkite
