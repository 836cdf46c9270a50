#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// Pinhole camera with a distortion model, given in the configuration.
struct CameraConfig {
  int width_px = 1920;
  int height_px = 1080;
  double focal_x_px = 1152;
  double focal_y_px = 1152;
  double centre_x_px = 959.5;
  double centre_y_px = 539.5;
  DistortionModel distortion = DistortionModel::none;
  std::vector<double> coefficients;

  static void fields(auto& self, auto&& field) {
    field("width_px", self.width_px, Range{16, 100000}, "image width");
    field("height_px", self.height_px, Range{16, 100000}, "image height");
    field("focal_x_px", self.focal_x_px, kPositive, "focal length along the rows, f_x");
    field("focal_y_px", self.focal_y_px, kPositive, "focal length along the columns, f_y");
    field("centre_x_px", self.centre_x_px,
          "principal point, c_x; the centre of the first pixel is 0");
    field("centre_y_px", self.centre_y_px, "principal point, c_y");
    field("distortion", self.distortion, "distortion model");
    field("coefficients", self.coefficients,
          "distortion coefficients: k1 k2 p1 p2 [k3 [k4 k5 k6]], or equidistant k1 k2 k3 k4");
  }
};

struct CalibrationConfig {
  std::optional<std::filesystem::path> path;
  std::optional<CameraConfig> camera;
  std::optional<std::filesystem::path> mask_path;

  static void fields(auto& self, auto&& field) {
    field("path", self.path,
          "EuRoC sensor.yaml, Kalibr camchain or OpenCV YAML; default: the data set's calibration");
    field("camera", self.camera, "camera parameters, instead of a file");
    field("mask_path", self.mask_path,
          "mask image, black where the scene is hidden: airframe, text overlay, vignette");
  }
};

/// Camera extrinsics: body (x forward, y left, z up) from camera.
struct MountConfig {
  std::optional<double> down_deg;
  std::optional<std::array<double, 4>> rotation_wxyz;
  std::array<double, 3> position_m{};

  static void fields(auto& self, auto&& field) {
    field("down_deg", self.down_deg, Range{-90, 90},
          "angle of the optical axis below the body's x-y plane, no roll: 0 forward, 90 down; "
          "default: the calibration's extrinsics, else 90");
    field("rotation_wxyz", self.rotation_wxyz, "quaternion body from camera, for any other mount");
    field("position_m", self.position_m,
          "camera position in the body; not in addition to the calibration's extrinsics");
  }
};

}  // namespace stillkite
