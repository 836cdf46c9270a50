#include "geometry/camera.hpp"

#include <Eigen/LU>
#include <cmath>

namespace stillkite {
namespace {

// Brown-Conrady with the rational radial polynomial of OpenCV.
DistortedPoint radial_tangential(const std::array<double, 8>& c, const Eigen::Vector2d& p) {
  const auto [k1, k2, p1, p2, k3, k4, k5, k6] = c;
  const double x = p.x();
  const double y = p.y();
  const double r2 = x * x + y * y;
  const double numerator = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double denominator = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double radial = numerator / denominator;
  const double d_numerator = k1 + r2 * (2 * k2 + r2 * 3 * k3);
  const double d_denominator = k4 + r2 * (2 * k5 + r2 * 3 * k6);
  const double d_radial = (d_numerator - radial * d_denominator) / denominator;  // d(radial)/d(r^2)

  DistortedPoint out;
  out.pixel = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
               y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  const double cross = 2 * x * y * d_radial + 2 * p1 * x + 2 * p2 * y;
  out.jacobian << radial + 2 * x * x * d_radial + 2 * p1 * y + 6 * p2 * x, cross, cross,
      radial + 2 * y * y * d_radial + 6 * p1 * y + 2 * p2 * x;
  return out;
}

// Kannala-Brandt: image radius = theta (1 + k1 theta^2 + k2 theta^4 + ...).
DistortedPoint equidistant(const std::array<double, 8>& c, const Eigen::Vector2d& p) {
  const double r = p.norm();
  if (r < 1e-8) return {p, Eigen::Matrix2d::Identity()};
  const double theta = std::atan(r);
  const double theta2 = theta * theta;
  const double poly = 1 + theta2 * (c[0] + theta2 * (c[1] + theta2 * (c[2] + theta2 * c[3])));
  const double d_poly =
      1 + theta2 * (3 * c[0] + theta2 * (5 * c[1] + theta2 * (7 * c[2] + theta2 * 9 * c[3])));
  const double scale = theta * poly / r;
  const double d_radius = d_poly / (1 + r * r);  // d(image radius)/dr
  const Eigen::Vector2d n = p / r;
  const Eigen::Matrix2d projector = n * n.transpose();
  return {scale * p, scale * (Eigen::Matrix2d::Identity() - projector) + d_radius * projector};
}

}  // namespace

DistortedPoint distort(const Camera& camera, const Eigen::Vector2d& point) {
  DistortedPoint out{point, Eigen::Matrix2d::Identity()};
  if (camera.distortion == DistortionModel::radial_tangential) {
    out = radial_tangential(camera.coefficients, point);
  } else if (camera.distortion == DistortionModel::equidistant) {
    out = equidistant(camera.coefficients, point);
  }
  const Eigen::Array2d focal(camera.focal_x_px, camera.focal_y_px);
  out.pixel = (out.pixel.array() * focal).matrix() +
              Eigen::Vector2d(camera.centre_x_px, camera.centre_y_px);
  out.jacobian = focal.matrix().asDiagonal() * out.jacobian;
  return out;
}

std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& x_in_camera) {
  if (!(x_in_camera.z() > 1e-9)) return std::nullopt;
  return distort(camera, x_in_camera.head<2>() / x_in_camera.z()).pixel;
}

std::optional<Eigen::Vector2d> undistort(const Camera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d focal(camera.focal_x_px, camera.focal_y_px);
  const Eigen::Vector2d image =
      (pixel - Eigen::Vector2d(camera.centre_x_px, camera.centre_y_px)).cwiseQuotient(focal);
  if (camera.distortion == DistortionModel::none) return image;
  Eigen::Vector2d point = image;
  if (camera.distortion == DistortionModel::equidistant) {
    // initial value: image radius = angle of incidence
    const double angle = std::min(image.norm(), 1.5);
    if (angle > 1e-8) point = image * (std::tan(angle) / image.norm());
  }
  constexpr int kMaxIterations = 30;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const DistortedPoint at = distort(camera, point);
    // fold of the distortion polynomial: not invertible
    if (!(at.jacobian.determinant() > 1e-9 * focal.prod())) return std::nullopt;
    const Eigen::Vector2d error = at.pixel - pixel;
    point -= at.jacobian.inverse() * error;
    if (!(point.squaredNorm() < 1e6)) return std::nullopt;
    // quadratic convergence: `point` already includes one more iteration
    if (error.squaredNorm() < 1e-20 * focal.squaredNorm()) return point;
  }
  return (distort(camera, point).pixel - pixel).norm() < 1e-6
             ? std::optional<Eigen::Vector2d>(point)
             : std::nullopt;
}

Camera half_resolution(const Camera& camera) {
  Camera half = camera;
  half.width_px = camera.width_px / 2;
  half.height_px = camera.height_px / 2;
  half.focal_x_px = 0.5 * camera.focal_x_px;
  half.focal_y_px = 0.5 * camera.focal_y_px;
  half.centre_x_px = 0.5 * (camera.centre_x_px - 0.5);
  half.centre_y_px = 0.5 * (camera.centre_y_px - 0.5);
  return half;
}

}  // namespace stillkite
