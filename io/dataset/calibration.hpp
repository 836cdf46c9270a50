#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

struct ConfigNode;

/// Intrinsics and extrinsics of one camera.
struct Calibration {
  Camera camera;
  std::optional<RigidTransform> body_from_camera;  ///< nullopt if the file has no extrinsics
};

/// Reads one of three formats, detected by its keys:
/// - EuRoC sensor.yaml: resolution, intrinsics, distortion_model, T_BS (body_from_sensor);
/// - Kalibr camchain: cam0, with T_cam_imu (camera_from_imu; body = IMU);
/// - OpenCV FileStorage: image_width, image_height, camera_matrix, distortion_coefficients
///   (4, 5 or 8; 4 for distortion_model equidistant or fisheye_model).
/// Throws InputError "file:line:column: key: problem".
[[nodiscard]] Calibration read_calibration(const std::filesystem::path& file);
[[nodiscard]] Calibration read_calibration(const ConfigNode& root);

/// Message if the model does not take n distortion coefficients; nullopt if it does.
[[nodiscard]] std::optional<std::string> coefficient_mismatch(DistortionModel model, std::size_t n);

/// Throws InputError "origin: problem" unless resolution and focal lengths are positive, the focal
/// lengths at least 10 % of the image, the principal point inside it and all numbers finite.
void check_camera(const Camera& camera, const std::string& origin);

}  // namespace stillkite
