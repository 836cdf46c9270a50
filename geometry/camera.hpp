#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

enum class DistortionModel { none, radial_tangential, equidistant };

template <>
struct EnumNames<DistortionModel> {
  static constexpr auto value = std::to_array<std::pair<DistortionModel, std::string_view>>(
      {{DistortionModel::none, "none"},
       {DistortionModel::radial_tangential, "radial-tangential"},
       {DistortionModel::equidistant, "equidistant"}});
};

/// Pinhole camera with lens distortion. Centre of the first pixel: (0, 0), as in OpenCV.
/// Coefficients: radial_tangential k1 k2 p1 p2 k3 k4 k5 k6 (OpenCV's order, unused ones zero);
/// equidistant k1 k2 k3 k4 (Kannala-Brandt, OpenCV's fisheye).
struct Camera {
  int width_px = 0;
  int height_px = 0;
  double focal_x_px = 0;
  double focal_y_px = 0;
  double centre_x_px = 0;
  double centre_y_px = 0;
  DistortionModel distortion = DistortionModel::none;
  std::array<double, 8> coefficients{};

  bool operator==(const Camera&) const = default;
};

/// Pixel of the point (x, y) of the plane z = 1 and its Jacobian d(pixel)/d(x, y).
struct DistortedPoint {
  Eigen::Vector2d pixel;
  Eigen::Matrix2d jacobian;
};
[[nodiscard]] DistortedPoint distort(const Camera& camera, const Eigen::Vector2d& point);

/// Pixel of a point in the camera frame; empty if the point is not in front of the camera.
[[nodiscard]] std::optional<Eigen::Vector2d> project(const Camera& camera,
                                                     const Eigen::Vector3d& x_in_camera);

/// Point (x, y) of the plane z = 1 that projects to the pixel (Newton's method on `distort`); empty
/// where the lens model is not invertible.
[[nodiscard]] std::optional<Eigen::Vector2d> undistort(const Camera& camera,
                                                       const Eigen::Vector2d& pixel);

/// Camera model of the image at half resolution, each pixel the mean of 2x2 pixels.
[[nodiscard]] Camera half_resolution(const Camera& camera);

/// Rolling shutter: exposure time of a row relative to the middle row, s. `readout_s`: readout time
/// of the whole frame.
[[nodiscard]] constexpr double row_time_offset_s(double readout_s, double row_px, int height_px) {
  return readout_s * (row_px - 0.5 * (height_px - 1)) / height_px;
}

}  // namespace stillkite
