#include "calibration/lens_model.hpp"

#include <fmt/core.h>

#include <cmath>

namespace stillkite {
namespace {

// Derivatives of the distorted point on z = 1 (geometry/camera.cpp) with respect to the
// coefficients.
using Coefficients = Eigen::Matrix<double, 2, 8>;

Coefficients by_radial_tangential(const std::array<double, 8>& c, const Eigen::Vector2d& p) {
  const auto [k1, k2, p1, p2, k3, k4, k5, k6] = c;
  const double r2 = p.squaredNorm();
  const double r4 = r2 * r2;
  const double N = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double D = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double slope = -N / (D * D);
  const double cross = 2 * p.x() * p.y();
  Coefficients J;
  J.col(0) = p * r2 / D;
  J.col(1) = p * r4 / D;
  J.col(2) << cross, r2 + 2 * p.y() * p.y();
  J.col(3) << r2 + 2 * p.x() * p.x(), cross;
  J.col(4) = p * r4 * r2 / D;
  J.col(5) = p * r2 * slope;
  J.col(6) = p * r4 * slope;
  J.col(7) = p * r4 * r2 * slope;
  return J;
}

Coefficients by_equidistant(const Eigen::Vector2d& p) {
  Coefficients J = Coefficients::Zero();
  const double r = p.norm();
  if (r < 1e-8) return J;
  const double theta = std::atan(r);
  double power = theta;
  for (int i = 0; i < 4; ++i) J.col(i) = p / r * (power *= theta * theta);
  return J;
}

double& parameter_of(Camera& camera, int parameter) {
  switch (parameter) {
    case 0:
      return camera.focal_x_px;
    case 1:
      return camera.focal_y_px;
    case 2:
      return camera.centre_x_px;
    case 3:
      return camera.centre_y_px;
    default:
      return camera.coefficients[static_cast<std::size_t>(parameter - 4)];
  }
}

}  // namespace

std::string name_of_model(const LensModel& model) {
  if (model.coefficients == 0) return "no distortion";
  return fmt::format("{}, {} coefficients", name_of(model.distortion), model.coefficients);
}

std::string name_of_parameter(const LensModel& model, int parameter) {
  constexpr std::array kIntrinsics{"focal_x_px", "focal_y_px", "centre_x_px", "centre_y_px"};
  constexpr std::array kCoefficients{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  if (parameter < 4) return kIntrinsics[static_cast<std::size_t>(parameter)];
  const auto i = static_cast<std::size_t>(parameter - 4);
  if (model.distortion == DistortionModel::equidistant) return fmt::format("k{}", i + 1);
  return kCoefficients[i];
}

double lens_parameter(const Camera& camera, int parameter) {
  Camera copy = camera;
  return parameter_of(copy, parameter);
}

void add_to_lens(Camera& camera, const Eigen::VectorXd& step) {
  for (int i = 0; i < step.size(); ++i) parameter_of(camera, i) += step(i);
}

std::optional<LensProjection> project_with_derivatives(const Camera& camera, const LensModel& model,
                                                       const Eigen::Vector3d& x_in_camera) {
  if (!(x_in_camera.z() > 1e-9)) return std::nullopt;
  const Eigen::Vector2d p = x_in_camera.head<2>() / x_in_camera.z();
  const DistortedPoint at = distort(camera, p);
  const Eigen::Array2d focal(camera.focal_x_px, camera.focal_y_px);
  const Eigen::Array2d centre(camera.centre_x_px, camera.centre_y_px);
  LensProjection out;
  out.pixel = at.pixel;
  out.by_parameters.setZero(2, model.parameters());
  out.by_parameters.leftCols<2>() = ((at.pixel.array() - centre) / focal).matrix().asDiagonal();
  out.by_parameters.middleCols<2>(2).setIdentity();
  if (model.coefficients > 0) {
    const Coefficients J = model.distortion == DistortionModel::equidistant
                               ? by_equidistant(p)
                               : by_radial_tangential(camera.coefficients, p);
    out.by_parameters.rightCols(model.coefficients) =
        focal.matrix().asDiagonal() * J.leftCols(model.coefficients);
  }
  Eigen::Matrix<double, 2, 3> projection;
  projection << 1, 0, -p.x(), 0, 1, -p.y();
  out.by_point = at.jacobian * projection / x_in_camera.z();
  return out;
}

}  // namespace stillkite
