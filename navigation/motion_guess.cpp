#include "navigation/motion_guess.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/plane.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

// Nearer to the horizon a view from above would be made of next to nothing.
constexpr double kMostTilt_rad = 0.9;

Eigen::Vector2d middle_px(const Camera& camera) {
  return {0.5 * (camera.width_px - 1), 0.5 * (camera.height_px - 1)};
}

}  // namespace

double prediction_sigma_px(const Camera& camera, const MotionFilter& filter) {
  // the point X = (0, 0, depth) moves by X x w - p for errors p, w of the pose, camera's axes
  const double closeness = std::max(0.0, inverse_depth(ground_seen_from(filter.pose()), {0, 0}));
  Eigen::Matrix<double, 2, 6> J = Eigen::Matrix<double, 2, 6>::Zero();
  J.row(0) << -closeness, 0, 0, 0, -1, 0;
  J.row(1) << 0, -closeness, 0, 1, 0, 0;
  J.row(0) *= camera.focal_x_px;
  J.row(1) *= camera.focal_y_px;
  const Eigen::Matrix3d R = filter.pose().rotation.conjugate().toRotationMatrix();
  Matrix6d camera_from_world = Matrix6d::Zero();
  camera_from_world.topLeftCorner<3, 3>() = R;
  camera_from_world.bottomRightCorner<3, 3>() = R;
  J *= camera_from_world;
  return std::sqrt((J * filter.pose_covariance() * J.transpose()).trace());
}

LevelView level_view(const Camera& camera, const Eigen::Vector3d& normal) {
  const Eigen::AngleAxisd level(
      Eigen::Quaterniond::FromTwoVectors(normal, Eigen::Vector3d::UnitZ()));
  LevelView out;
  out.view_from_camera = Eigen::AngleAxisd(std::min(level.angle(), kMostTilt_rad), level.axis());
  Eigen::Matrix3d K;
  K << camera.focal_x_px, 0, camera.centre_x_px, 0, camera.focal_y_px, camera.centre_y_px, 0, 0, 1;
  const Eigen::Vector3d middle = middle_px(camera).homogeneous();
  const Eigen::Vector3d towards = out.view_from_camera * K.inverse() * middle;
  // what the middle shows is as large as in the image
  out.K = K;
  out.K.topLeftCorner<2, 2>() *= towards.z();
  out.K.topRightCorner<2, 1>().setZero();
  out.K.topRightCorner<2, 1>() = (middle - out.K * (towards / towards.z())).head<2>();
  out.homography = out.K * out.view_from_camera.toRotationMatrix() * K.inverse();
  return out;
}

std::vector<PlaneMotion> motions_of(const ImageShift& shift, const Camera& camera,
                                    const LevelView& view, const Eigen::Vector3d& normal) {
  const Eigen::Matrix3d K_inverse = view.K.inverse();
  const Eigen::Vector3d b = K_inverse * middle_px(camera).homogeneous();
  const Eigen::Vector3d b_now = K_inverse * (middle_px(camera) + shift.shift_px).homogeneous();
  const Eigen::Vector3d n = view.view_from_camera * normal;
  const Eigen::Quaterniond camera_from_view = view.view_from_camera.conjugate();
  const auto in_camera = [&](const Eigen::Quaterniond& rotation, const Eigen::Vector3d& way) {
    return PlaneMotion{.rotation = camera_from_view * rotation * view.view_from_camera,
                       .translation = camera_from_view * way,
                       .normal = normal};
  };
  std::vector<PlaneMotion> out;
  const double rho = n.dot(b);
  const double rho_now = n.dot(b_now);
  if (rho > 0 && rho_now > 0) {
    // rho t = lambda b' - R b with n . t = 0
    const Eigen::Quaterniond turn = so3_exp(shift.turn_rad * n);
    out.push_back(in_camera(turn, b_now / rho_now - turn * b / rho));
  }
  const Eigen::Quaterniond aside = Eigen::Quaterniond::FromTwoVectors(b, b_now);
  out.push_back(in_camera(aside * so3_exp(shift.turn_rad * b.normalized()), {0, 0, 0}));
  return out;
}

}  // namespace stillkite
