#include "io/dataset/calibration_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>

#include "io/config/config_values.hpp"

namespace stillkite {
namespace {

std::string extrinsics_yaml(const RigidTransform& body_from_camera) {
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = body_from_camera.rotation.toRotationMatrix();
  T.topRightCorner<3, 1>() = body_from_camera.translation;
  return fmt::format("T_BS:\n  cols: 4\n  rows: 4\n  data: [{}]\n",
                     fmt::join(T.data(), T.data() + T.size(), ", "));
}

}  // namespace

std::string calibration_yaml(const CalibrationFile& file) {
  const Camera& camera = file.camera;
  const auto& c = camera.coefficients;
  return fmt::format(
      "sensor_type: camera\n"
      "comment: {}\n"
      "{}{}{}"
      "resolution: [{}, {}]\n"
      "camera_model: pinhole\n"
      "intrinsics: [{}, {}, {}, {}]  # {}\n"
      "distortion_model: {}\n"
      "distortion_coefficients: [{}]{}\n{}",
      print_text(file.comment),
      file.body_from_camera ? extrinsics_yaml(*file.body_from_camera) : "",
      file.timeshift_cam_imu_s ? fmt::format("timeshift_cam_imu: {}\n", *file.timeshift_cam_imu_s)
                               : "",
      file.rate_hz ? fmt::format("rate_hz: {}\n", *file.rate_hz) : "", camera.width_px,
      camera.height_px, camera.focal_x_px, camera.focal_y_px, camera.centre_x_px,
      camera.centre_y_px, file.intrinsics_note, name_of(camera.distortion),
      fmt::join(c.begin(), c.begin() + file.coefficients, ", "),
      file.coefficients_note.empty() ? "" : "  # " + file.coefficients_note, file.notes);
}

}  // namespace stillkite
