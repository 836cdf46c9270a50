#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// A camera written out in the configuration itself.
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
    field("width_px", self.width_px, Range{16, 100000}, "of the image");
    field("height_px", self.height_px, Range{16, 100000}, "of the image");
    field("focal_x_px", self.focal_x_px, kPositive, "focal length along the rows");
    field("focal_y_px", self.focal_y_px, kPositive, "focal length along the columns");
    field("centre_x_px", self.centre_x_px, "principal point; the first pixel's centre is 0");
    field("centre_y_px", self.centre_y_px, "principal point");
    field("distortion", self.distortion, "model of the lens");
    field("coefficients", self.coefficients,
          "of the lens: k1 k2 p1 p2 [k3 [k4 k5 k6]], or equidistant k1 k2 k3 k4");
  }
};

struct CalibrationConfig {
  std::optional<std::filesystem::path> path;
  std::optional<CameraConfig> camera;
  std::optional<std::filesystem::path> mask_path;

  static void fields(auto& self, auto&& field) {
    field("path", self.path,
          "EuRoC sensor.yaml, Kalibr camchain or OpenCV YAML; without it the data set's own");
    field("camera", self.camera, "instead of a file");
    field("mask_path", self.mask_path,
          "an image, black where no world is seen: the aircraft's legs, text, a lens's dark rim");
  }
};

/// How the camera sits in the body (x forward, y left, z up).
struct MountConfig {
  std::optional<double> down_deg;
  std::optional<std::array<double, 4>> rotation_wxyz;
  std::array<double, 3> position_m{};

  static void fields(auto& self, auto&& field) {
    field("down_deg", self.down_deg, Range{-90, 90},
          "optical axis below the body's horizon, image upright: 0 forward, 90 straight down; "
          "without it and the next the calibration's, else 90");
    field("rotation_wxyz", self.rotation_wxyz, "any other mount: quaternion body from camera");
    field("position_m", self.position_m, "of the camera in the body; used with one of the two");
  }
};

}  // namespace stillkite
