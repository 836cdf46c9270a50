#pragma once

#include <array>
#include <optional>

#include "geometry/camera.hpp"
#include "geometry/fields.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/render/develop.hpp"

namespace stillkite {

/// Defaults: the flow paper's camera (section 5.1), nadir-looking.
struct SimulatedCameraConfig {
  double frames_per_s = 25;
  int width_px = 1920;
  int height_px = 1080;
  double focal_x_px = 1152.77;
  double focal_y_px = 1150.483;
  double centre_x_px = 969.2111;
  double centre_y_px = 535.3755;
  DistortionModel distortion = DistortionModel::none;
  std::array<double, 8> coefficients{};
  double forward_tilt_deg = 0;
  int supersampling = 2;
  double shutter_s = 0;
  int shutter_samples = 4;
  double readout_s = 0;
  double noise_grey = 2;
  double gain_ramp_ratio = 0;
  double flicker_ratio = 0;

  static void fields(auto& self, auto&& field) {
    field("frames_per_s", self.frames_per_s, Range{0.1, 1000}, "frame rate");
    field("width_px", self.width_px, Range{16, 16384}, "image width");
    field("height_px", self.height_px, Range{16, 16384}, "image height");
    field("focal_x_px", self.focal_x_px, kPositive, "focal length along x");
    field("focal_y_px", self.focal_y_px, kPositive, "focal length along y");
    field("centre_x_px", self.centre_x_px, kAny, "principal point, first pixel's centre is 0");
    field("centre_y_px", self.centre_y_px, kAny, "principal point, first pixel's centre is 0");
    field("distortion", self.distortion, "distortion model");
    field("coefficients", self.coefficients, kAny, "k1 k2 p1 p2 k3 k4 k5 k6, or k1 k2 k3 k4");
    field("forward_tilt_deg", self.forward_tilt_deg, Range{-90, 90},
          "angle of the optical axis in the body from nadir towards the nose");
    field("supersampling", self.supersampling, Range{1, 4}, "samples per pixel and direction");
    field("shutter_s", self.shutter_s, kNonNegative, "exposure time (motion blur); 0: no blur");
    field("shutter_samples", self.shutter_samples, Range{1, 64}, "instants per exposure");
    field("readout_s", self.readout_s, Range{0, 0.1},
          "rolling shutter: time from the first row to the last; stamps refer to the middle row");
    field("noise_grey", self.noise_grey, Range{0, 100}, "noise of a pixel, 1 sigma");
    field("gain_ramp_ratio", self.gain_ramp_ratio, Range{-0.99, 10},
          "relative change of the gain from the first frame to the last; 0.3: 30 % brighter");
    field("flicker_ratio", self.flicker_ratio, Range{0, 0.9},
          "maximum random relative change of a frame's gain");
  }

  /// Gain relative to the first frame. `progress` in [0, 1]; `draw`: random, in [-1, 1].
  [[nodiscard]] double gain(double progress, double draw) const {
    return (1 + gain_ramp_ratio * progress) * (1 + flicker_ratio * draw);
  }

  [[nodiscard]] Camera lens() const {
    return {width_px,    height_px,   focal_x_px, focal_y_px,
            centre_x_px, centre_y_px, distortion, coefficients};
  }
};

/// Camera of a free flight.
struct FlightCameraConfig : SimulatedCameraConfig {
  std::array<double, 3> lever_arm_m{};
  double lens_error_px = 0;
  double light_ratio = 1;
  double amplifier_gain = 1;
  std::optional<double> full_well_electrons{};

  static void fields(auto& self, auto&& field) {
    SimulatedCameraConfig::fields(self, field);
    field("lever_arm_m", self.lever_arm_m, kAny,
          "position [x, y, z] of the camera in the body; IMU and range finder are at its origin");
    field("lens_error_px", self.lens_error_px, Range{0, 20},
          "smooth displacement of the image from the written calibration, RMS of its length");
    field("light_ratio", self.light_ratio, Range{1e-6, 1}, "light relative to daylight");
    field("amplifier_gain", self.amplifier_gain, kPositive,
          "amplification of signal and noise; 1: daylight");
    field("full_well_electrons", self.full_well_electrons, kPositive,
          "electrons at grey 255 and amplifier_gain 1, for photon noise; null: no photon noise");
  }

  /// With light L, amplifier A and full well N: signal s = A L g of a daylight grey g, variance of
  /// the photon noise 255 A s / N, of the read noise (A noise_grey)^2.
  [[nodiscard]] Exposure exposure(double frame_gain) const {
    return {.gain = frame_gain * amplifier_gain * light_ratio,
            .noise_grey = amplifier_gain * noise_grey,
            .photon_variance_per_grey =
                full_well_electrons ? 255 * amplifier_gain / *full_well_electrons : 0};
  }

  [[nodiscard]] RigidTransform body_from_camera() const {
    return {camera_raised_forward(forward_tilt_deg).rotation,
            {lever_arm_m[0], lever_arm_m[1], lever_arm_m[2]}};
  }
};

}  // namespace stillkite
