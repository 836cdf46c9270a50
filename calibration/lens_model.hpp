#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Lens model and number of its coefficients that are estimated.
struct LensModel {
  DistortionModel distortion = DistortionModel::none;
  int coefficients = 0;

  [[nodiscard]] int parameters() const { return 4 + coefficients; }
  bool operator==(const LensModel&) const = default;
};

/// Models that a run reads, simplest first.
inline constexpr std::array<LensModel, 5> kLensModels{
    LensModel{DistortionModel::none, 0}, LensModel{DistortionModel::radial_tangential, 4},
    LensModel{DistortionModel::equidistant, 4}, LensModel{DistortionModel::radial_tangential, 5},
    LensModel{DistortionModel::radial_tangential, 8}};

/// "radial-tangential, 4 coefficients".
[[nodiscard]] std::string name_of_model(const LensModel& model);

/// Name of a parameter: focal_x_px, ..., k1. Parameters: f_x, f_y, c_x, c_y, coefficients.
[[nodiscard]] std::string name_of_parameter(const LensModel& model, int parameter);

[[nodiscard]] double lens_parameter(const Camera& camera, int parameter);
void add_to_lens(Camera& camera, const Eigen::VectorXd& step);

/// Image point with its derivatives with respect to the lens parameters and to the point.
struct LensProjection {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, Eigen::Dynamic> by_parameters;
  Eigen::Matrix<double, 2, 3> by_point;
};
/// Empty if the point is not in front of the camera.
[[nodiscard]] std::optional<LensProjection> project_with_derivatives(
    const Camera& camera, const LensModel& model, const Eigen::Vector3d& x_in_camera);

}  // namespace stillkite
