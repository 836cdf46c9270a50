#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

struct ConfigNode;

/// Intrinsics and extrinsics of one camera.
struct Calibration {
  Camera camera;
  std::optional<RigidTransform> body_from_camera;  ///< nullopt if the file has no extrinsics
  std::optional<double> timeshift_cam_imu_s;       ///< t_imu = t_cam + timeshift (Kalibr)
};

/// Reads one of three formats, detected by its keys:
/// - EuRoC sensor.yaml: resolution, intrinsics, distortion_model;
/// - Kalibr camchain, OpenVINS: the same in cam0;
/// - OpenCV FileStorage, YAML or XML: image_width, image_height, camera_matrix,
///   distortion_coefficients.
/// In each, the extrinsics by any name of mount_key() and the clock by timeshift_cam_imu; other
/// keys that look like a mount, a clock or a lens are errors.
/// Throws InputError "file:line:column: key: problem".
[[nodiscard]] Calibration read_calibration(const std::filesystem::path& file);
[[nodiscard]] Calibration read_calibration(const ConfigNode& root);

/// Rigid transform of a 4 x 4 matrix: a list of 16 numbers, a list of rows, or {rows, cols, data}.
[[nodiscard]] RigidTransform read_transform(const ConfigNode& node, const std::string& key);

/// Sets model and coefficients. Returns a message if the model does not take that many; zeros after
/// the model's last coefficient are accepted (OpenCV's 12 and 14).
[[nodiscard]] std::optional<std::string> set_distortion(Camera& camera, DistortionModel model,
                                                        std::span<const double> coefficients);

}  // namespace stillkite
