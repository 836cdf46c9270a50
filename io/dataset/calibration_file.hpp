#pragma once

#include <optional>
#include <string>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Content of a camera's sensor.yaml in EuRoC's layout, which read_calibration() reads.
struct CalibrationFile {
  Camera camera;
  int coefficients = 4;  ///< number of written distortion coefficients
  std::string comment;   ///< value of the key `comment`
  std::optional<RigidTransform> body_from_camera;
  std::optional<double> timeshift_cam_imu_s;
  std::optional<double> rate_hz;
  std::string intrinsics_note = "fu, fv, cu, cv";  ///< YAML comments of the lines
  std::string coefficients_note;
  std::string notes;  ///< comment lines at the end, each with its #
};
[[nodiscard]] std::string calibration_yaml(const CalibrationFile& file);

}  // namespace stillkite
