#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

/// `depth_correlated_frames` with a consistent covariance if initial speed and height are unknown.
inline constexpr double kCarefulFrames = 300;

/// Estimator of policy fused.
enum class FusionSolver { filter, window };
template <>
struct EnumNames<FusionSolver> {
  static constexpr auto value = std::to_array<std::pair<FusionSolver, std::string_view>>(
      {{FusionSolver::filter, "filter"}, {FusionSolver::window, "window"}});
};

/// What the fusion filter is told of its sensors and of the drone.
struct FusionConfig {
  FusionSolver solver = FusionSolver::filter;
  double pixel_sigma_px = 0.004;
  double pixel_noise_ratio = 0.54;
  double window_error_ratio = 1.0;
  double window_error_way = 0.03;
  double stray_above_ratio = 1.3;
  double stray_correlated_frames = 10;
  double gate_sigma = 4.0;
  bool flat_ground = false;
  int landmarks = 96;
  int min_landmarks = 12;
  double renew_below_ratio = 0.3;
  double inverse_depth_sigma_ratio = 1.0;
  double scale_sigma_ratio = 0.5;
  double metric_below_sigma_ratio = 0.25;
  double height_sigma_ratio = 0.02;
  double ground_sigma_ratio = 0.01;
  double keyframe_view_sigma_ratio = 0.02;
  double flow_correlated_s = 1.0;
  double height_correlated_frames = 10;
  double depth_correlated_frames = 60;
  bool relinearize_start = true;
  double scale_correlated_s = 5.0;
  double acceleration_density = 1.0;
  double gyro_density = 5e-4;
  double gyro_bias_sigma_rad_s = 0.01;
  double gyro_bias_walk = 5e-5;
  double accel_density = 0.01;
  double accel_bias_sigma_m_s2 = 0.05;
  double accel_bias_walk = 3e-3;

  static void fields(auto& self, auto&& field) {
    field("solver", self.solver,
          "error-state filter, or visual-inertial sliding window; the window needs an IMU and no "
          "height, and uses the noise of the IMU only");
    field("pixel_sigma_px", self.pixel_sigma_px, Range{1e-9, 1e9},
          "of a feature's place, beside what its window and its frame tell");
    field(
        "pixel_noise_ratio", self.pixel_noise_ratio, Range{0, 1e9},
        "sigma of a view over what the noise in its window and the features of its frame, by what "
        "they are off by from their epipolar lines, tell of it; about half of its variance lasts, "
        "which `window_error_ratio` tells");
    field(
        "window_error_ratio", self.window_error_ratio, Range{0, 1e9},
        "sigma of what a feature's window is off by as long as the camera stays where it is, over "
        "that of a view");
    field("window_error_way", self.window_error_way, Range{1e-9, 1e9},
          "over which, near the reference, that becomes another and both variances grow by one of "
          "theirs, as a share of depth");
    field(
        "stray_above_ratio", self.stray_above_ratio, Range{.min = 1},
        "a landmark whose views are off, squared, by more times what is usual in their frames lies "
        "where depths meet, or moves");
    field("stray_correlated_frames", self.stray_correlated_frames, Range{0, 1e9},
          "frames over which it is off alike; the variance of its views grows by that many times "
          "what exceeds the ratio");
    field(
        "gate_sigma", self.gate_sigma, Range{1e-9, 1e9},
        "a measurement further than that from its prediction, root mean square of its components, "
        "is left out");
    field("flat_ground", self.flat_ground,
          "what is seen is known to be flat and level; else the features must show it before the "
          "flow is believed");
    field("landmarks", self.landmarks, Range{8, 200},
          "features of the reference whose place in space is estimated");
    field("min_landmarks", self.min_landmarks, Range{4, 200},
          "seen in a frame, without which it measured nothing but flat ground");
    field("renew_below_ratio", self.renew_below_ratio, Range{0, 0.9},
          "replaces `reference.renew_below_ratio`, at least that: what is known of the landmarks "
          "goes over into the new reference, and few that are left are seen from ever stranger "
          "places");
    field("inverse_depth_sigma_ratio", self.inverse_depth_sigma_ratio, Range{1e-9, 1e9},
          "of a new landmark's inverse depth, as a share of its guess");
    field("scale_sigma_ratio", self.scale_sigma_ratio, Range{1e-9, 1e9},
          "of the metres that the first landmarks were guessed in");
    field("metric_below_sigma_ratio", self.metric_below_sigma_ratio, Range{1e-9, 1e9},
          "the answer is in metres once the scale is known to that share; before, its scale is "
          "`none`");
    field("height_sigma_ratio", self.height_sigma_ratio, Range{1e-9, 1e9},
          "of the height at the start, which is the flow's scale");
    field("ground_sigma_ratio", self.ground_sigma_ratio, Range{1e-9, 1e9},
          "how far a landmark that is taken for one of the ground may be over or under it, as a "
          "share of the height");
    field("keyframe_view_sigma_ratio", self.keyframe_view_sigma_ratio, Range{0, 1e9},
          "error of the flow's way since its keyframe as a share of it, beside its covariance: "
          "ground that is not flat");
    field(
        "flow_correlated_s", self.flow_correlated_s, Range{0, 1e9},
        "time over which the flow's errors are alike, as long as a keyframe lasts; its variance is "
        "taken as many times as frames fall into it");
    field("height_correlated_frames", self.height_correlated_frames, Range{.min = 1},
          "the same of a range finder's or barometer's height");
    field("depth_correlated_frames", self.depth_correlated_frames, Range{0, 1e9},
          "frames over which what way and depths are not known to moves the features alike; the "
          "variance of their product is taken that many times, until the start has been gone "
          "through again");
    field("relinearize_start", self.relinearize_start,
          "what was seen of the first reference is gone through again, once 16 and 32 frames of it "
          "are there and later where these do not suffice, about the depths that it tells as a "
          "whole");
    field("scale_correlated_s", self.scale_correlated_s, Range{0, 1e9},
          "time over which what scale and acceleration are not known to moves the camera alike");
    field("acceleration_density", self.acceleration_density, Range{1e-9, 1e9},
          "white acceleration of the drone where no accelerometer is read, m/s^2/sqrt(Hz)");
    field("gyro_density", self.gyro_density, Range{1e-9, 1e9}, "white noise, rad/s/sqrt(Hz)");
    field("gyro_bias_sigma_rad_s", self.gyro_bias_sigma_rad_s, Range{1e-9, 1e9},
          "of the bias at the start");
    field("gyro_bias_walk", self.gyro_bias_walk, Range{0, 1e9}, "rad/s^2/sqrt(Hz)");
    field("accel_density", self.accel_density, Range{1e-9, 1e9}, "white noise, m/s^2/sqrt(Hz)");
    field("accel_bias_sigma_m_s2", self.accel_bias_sigma_m_s2, Range{1e-9, 1e9},
          "of the bias at the start");
    field("accel_bias_walk", self.accel_bias_walk, Range{0, 1e9}, "m/s^3/sqrt(Hz)");
  }
};

}  // namespace stillkite
