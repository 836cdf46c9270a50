#include "io/dataset/flight_camera.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "geometry/angle.hpp"
#include "io/config/config_values.hpp"
#include "io/dataset/camera_check.hpp"
#include "io/dataset/lens_check.hpp"

namespace stillkite {
namespace {

Calibration calibration_of(const CameraConfig& config) {
  Camera camera{.width_px = config.width_px,
                .height_px = config.height_px,
                .focal_x_px = config.focal_x_px,
                .focal_y_px = config.focal_y_px,
                .centre_x_px = config.centre_x_px,
                .centre_y_px = config.centre_y_px};
  if (const auto wrong = set_distortion(camera, config.distortion, config.coefficients)) {
    throw InputError("calibration.camera.coefficients: " + *wrong);
  }
  check_camera(camera, "calibration.camera");
  return {.camera = camera};
}

// R = [-y_B, -s x_B - c z_B, c x_B - s z_B], c = cos(down), s = sin(down): no roll.
Eigen::Quaterniond body_from_camera_looking_down(double down_deg) {
  const double c = std::cos(down_deg * kDegree);
  const double s = std::sin(down_deg * kDegree);
  Eigen::Matrix3d R;
  R.col(0) << 0, -1, 0;
  R.col(1) << -s, 0, -c;
  R.col(2) << c, 0, -s;
  return Eigen::Quaterniond(R);
}

}  // namespace

NamedCalibration configured_calibration(const RunConfig& config,
                                        const std::optional<EurocDataset>& dataset) {
  if (config.calibration.path && config.calibration.camera) {
    throw InputError("calibration.path and calibration.camera are both set; keep one");
  }
  if (config.calibration.camera) {
    return {calibration_of(*config.calibration.camera), "calibration.camera"};
  }
  if (config.calibration.path || (dataset && dataset->calibration)) {
    const auto file = config.calibration.path ? *config.calibration.path : *dataset->calibration;
    return {read_calibration(file), file.string()};
  }
  throw InputError(config.source.path.string() +
                   ": no calibration found; set calibration.path or calibration.camera");
}

Calibration find_calibration(const RunConfig& config, const std::optional<EurocDataset>& dataset,
                             const cv::Size& size, const ImageMask* mask) {
  const auto [found, origin] = configured_calibration(config, dataset);
  if (found.camera.width_px != size.width || found.camera.height_px != size.height) {
    throw InputError(fmt::format(
        "{}: calibration of {}x{} images, but {} has {}x{}; give the calibration of this "
        "resolution",
        origin, found.camera.width_px, found.camera.height_px, config.source.path.string(),
        size.width, size.height));
  }
  check_lens(found.camera, mask, origin);
  return found;
}

RigidTransform mount_of(const MountConfig& mount, const Calibration& calibration) {
  const Eigen::Vector3d position = Eigen::Vector3d::Map(mount.position_m.data());
  if (mount.rotation_wxyz) {
    if (mount.down_deg) {
      throw InputError("mount.down_deg and mount.rotation_wxyz are both set; keep one");
    }
    return {unit_quaternion(*mount.rotation_wxyz, "mount.rotation_wxyz"), position};
  }
  if (!mount.down_deg && calibration.body_from_camera) {
    if (!position.isZero(0)) {
      throw InputError(
          "mount.position_m: the calibration has extrinsics; set mount.down_deg or "
          "mount.rotation_wxyz to replace them, or remove mount.position_m");
    }
    return *calibration.body_from_camera;
  }
  return {body_from_camera_looking_down(mount.down_deg.value_or(90.0)), position};
}

std::optional<std::string> replaced_mount_note(const MountConfig& mount,
                                               const Calibration& calibration) {
  constexpr double kMaxDifference_rad = 3 * kDegree;
  if (!calibration.body_from_camera || !(mount.down_deg || mount.rotation_wxyz)) {
    return std::nullopt;
  }
  const Eigen::Quaterniond& by_calibration = calibration.body_from_camera->rotation;
  const double difference_rad =
      angle_between_rad(mount_of(mount, calibration).rotation, by_calibration);
  if (difference_rad <= kMaxDifference_rad) return std::nullopt;
  const Eigen::Vector3d axis = by_calibration * Eigen::Vector3d::UnitZ();
  return fmt::format(
      "{} replaces the calibration's mount, which differs by {:.0f} deg (its optical axis is "
      "{:.0f} deg below the horizon of the body: x forward, y left, z up); remove one of them",
      mount.rotation_wxyz ? "mount.rotation_wxyz" : "mount.down_deg", difference_rad / kDegree,
      std::atan2(-axis.z(), axis.head<2>().norm()) / kDegree);
}

}  // namespace stillkite
