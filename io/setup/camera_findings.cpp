#include "io/setup/camera_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/angle.hpp"
#include "io/dataset/lens_check.hpp"

namespace stillkite {
namespace {

std::string camera_yaml(const Camera& camera) {
  std::string text = fmt::format(
      "calibration: {{camera: {{width_px: {}, height_px: {}, focal_x_px: {:.6g}, focal_y_px: "
      "{:.6g}, "
      "centre_x_px: {:.6g}, centre_y_px: {:.6g}",
      camera.width_px, camera.height_px, camera.focal_x_px, camera.focal_y_px, camera.centre_x_px,
      camera.centre_y_px);
  if (camera.distortion != DistortionModel::none) {
    text += fmt::format(", distortion: {}, coefficients: [", name_of(camera.distortion));
    const std::size_t count = camera.distortion == DistortionModel::equidistant ? 4 : 8;
    for (std::size_t i = 0; i < count; ++i) {
      text += fmt::format("{}{:.8g}", i == 0 ? "" : ", ", camera.coefficients[i]);
    }
    text += "]";
  }
  return text + "}}";
}

// Largest angle of a corner off the optical axis.
double corner_angle_rad(const Camera& camera) {
  double angle_rad = 0;
  for (const double x : {0, camera.width_px - 1}) {
    for (const double y : {0, camera.height_px - 1}) {
      if (const auto point = undistort(camera, {x, y})) {
        angle_rad = std::max(angle_rad, std::atan(point->norm()));
      }
    }
  }
  return angle_rad;
}

}  // namespace

std::optional<Camera> scaled_to(const Camera& camera, int width_px, int height_px) {
  const double scale = static_cast<double>(width_px) / camera.width_px;
  if (std::abs(scale * camera.height_px - height_px) > 0.5) return std::nullopt;
  Camera out = camera;
  out.width_px = width_px;
  out.height_px = height_px;
  out.focal_x_px *= scale;
  out.focal_y_px *= scale;
  out.centre_x_px = scale * (camera.centre_x_px + 0.5) - 0.5;
  out.centre_y_px = scale * (camera.centre_y_px + 0.5) - 0.5;
  return out;
}

SetupFinding resolution_finding(const Camera& camera, int width_px, int height_px) {
  SetupFinding out{.question = "resolution",
                   .verdict = SetupVerdict::ok,
                   .text = fmt::format("images {}x{}, calibration {}x{}", width_px, height_px,
                                       camera.width_px, camera.height_px)};
  if (camera.width_px == width_px && camera.height_px == height_px) return out;
  out.verdict = SetupVerdict::wrong;
  const std::optional<Camera> scaled = scaled_to(camera, width_px, height_px);
  out.remedy = scaled ? "calibrate at this resolution; if the images are only scaled: " +
                            camera_yaml(*scaled)
                      : "calibrate at this resolution: the aspect ratio differs, so the image is "
                        "cropped";
  return out;
}

SetupFinding lens_finding(const Camera& camera, const ImageMask* mask, const std::string& origin) {
  SetupFinding out{.question = "lens"};
  try {
    check_lens(camera, mask, origin);
  } catch (const InputError& error) {
    out.verdict = SetupVerdict::wrong;
    out.text = error.what();
    return out;
  }
  const double angle_deg = corner_angle_rad(camera) / kDegree;
  out.verdict = SetupVerdict::ok;
  out.text = fmt::format("{}, monotonic up to the corners, {:.1f} deg off the optical axis",
                         name_of(camera.distortion), angle_deg);
  out.measured = SetupMeasurement{angle_deg, {}, {}, "deg"};
  return out;
}

std::optional<std::string> no_ground_in_view(const Camera& camera,
                                             const Eigen::Quaterniond& world_from_camera) {
  const Eigen::Vector3d up = world_from_camera.conjugate() * Eigen::Vector3d::UnitZ();
  for (const double x : {0, camera.width_px - 1}) {
    for (const double y : {0, camera.height_px - 1}) {
      const auto point = undistort(camera, {x, y});
      if (!point || point->homogeneous().dot(up) < 0) return std::nullopt;
    }
  }
  return fmt::format(
      "no ground in the initial view: mount and attitude point the camera {:.0f} deg above the "
      "horizon; check mount.down_deg or the calibration's mount, initial.roll_deg and "
      "initial.pitch_deg",
      std::atan2(up.z(), up.head<2>().norm()) / kDegree);
}

}  // namespace stillkite
