#include "io/video/overlay_geometry.hpp"

#include <cmath>

namespace stillkite {
namespace {

/// Pixel of a point of the plane z = 1, if inside the image. Rejects points outside the valid range
/// of the distortion polynomial, which folds them back into the image.
std::optional<Eigen::Vector2d> visible(const Camera& camera, const Eigen::Vector2d& point) {
  const Eigen::Vector2d pixel = distort(camera, point).pixel;
  const bool inside = pixel.x() >= -0.5 && pixel.x() <= camera.width_px - 0.5 &&
                      pixel.y() >= -0.5 && pixel.y() <= camera.height_px - 0.5;
  if (!inside) return std::nullopt;
  const auto back = undistort(camera, pixel);
  if (!back || (*back - point).norm() > 1e-3 * (1 + point.norm())) return std::nullopt;
  return pixel;
}

}  // namespace

std::vector<Eigen::Vector2d> horizon_pixels(const Camera& camera,
                                            const Eigen::Quaterniond& world_from_camera) {
  // Horizon: n . (x, y, 1) = 0, n = vertical of the world in the camera frame.
  const Eigen::Vector3d n = world_from_camera.conjugate() * Eigen::Vector3d::UnitZ();
  const double slope = n.head<2>().norm();
  if (slope < 1e-9) return {};
  const Eigen::Vector2d foot = -n.z() / (slope * slope) * n.head<2>();
  Eigen::Vector2d along = Eigen::Vector2d(-n.y(), n.x()) / slope;
  if (along.x() < 0) along = -along;
  std::vector<Eigen::Vector2d> pixels;
  // Uniform in the viewing angle, for wide-angle lenses.
  constexpr int kHalfSamples = 200;
  constexpr double kMaxAngle_rad = 1.5;  // to either side
  for (int i = -kHalfSamples; i <= kHalfSamples; ++i) {
    const double t = std::tan(kMaxAngle_rad * i / kHalfSamples);
    if (const auto pixel = visible(camera, foot + t * along)) pixels.push_back(*pixel);
  }
  return pixels;
}

std::optional<Eigen::Vector2d> direction_pixel(const Camera& camera,
                                               const Eigen::Vector3d& direction_in_camera) {
  constexpr double kMinCosine = 1e-3;
  if (!(direction_in_camera.z() > kMinCosine * direction_in_camera.norm())) {
    return std::nullopt;
  }
  return visible(camera, direction_in_camera.hnormalized());
}

}  // namespace stillkite
