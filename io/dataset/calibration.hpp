#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

struct ConfigNode;

/// What a calibration file says of one camera.
struct Calibration {
  Camera camera;
  std::optional<RigidTransform> body_from_camera;  ///< where the file has extrinsics
};

/// Reads, by the keys it finds,
/// - EuRoC sensor.yaml: resolution, intrinsics, distortion_model, T_BS (body_from_sensor);
/// - Kalibr camchain: its cam0, with T_cam_imu (camera_from_imu; the IMU is the body);
/// - OpenCV FileStorage: image_width, image_height, camera_matrix, distortion_coefficients (4, 5 or
///   8 of them; with distortion_model or fisheye_model: equidistant also the fisheye's 4).
/// Throws InputError with file:line:column, key and remedy.
[[nodiscard]] Calibration read_calibration(const std::filesystem::path& file);
[[nodiscard]] Calibration read_calibration(const ConfigNode& root);

/// What is wrong with n coefficients of a lens of that model, if anything.
[[nodiscard]] std::optional<std::string> misfit(DistortionModel model, std::size_t n);

/// Throws InputError beginning with `origin` unless all numbers are finite, the focal lengths and
/// the resolution positive and the principal point near the image.
void check_camera(const Camera& camera, const std::string& origin);

}  // namespace stillkite
