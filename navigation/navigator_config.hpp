#pragma once

#include "estimation/ego_motion/motion_filter_config.hpp"
#include "estimation/fusion/fusion_config.hpp"
#include "estimation/plane/levelling_config.hpp"
#include "estimation/plane/plane_alignment_config.hpp"
#include "geometry/fields.hpp"
#include "navigation/paper_config.hpp"
#include "navigation/reference_config.hpp"
#include "stabilization/estimate_choice_config.hpp"

namespace stillkite {

/// Estimation procedure: as printed in the papers, or the recommended one.
enum class Mode { paper, recommended };
template <>
struct EnumNames<Mode> {
  static constexpr auto value = std::to_array<std::pair<Mode, std::string_view>>(
      {{Mode::paper, "paper"}, {Mode::recommended, "recommended"}});
};

/// Estimator whose result is returned: optical flow over the ground plane, relative pose to a
/// reference image, one of both per frame (best), or a filter of both (fused).
enum class Policy { flow, reference, best, fused };
template <>
struct EnumNames<Policy> {
  static constexpr auto value =
      std::to_array<std::pair<Policy, std::string_view>>({{Policy::flow, "flow"},
                                                          {Policy::reference, "reference"},
                                                          {Policy::best, "best"},
                                                          {Policy::fused, "fused"}});
};

struct EstimatorConfig {
  Policy policy = Policy::flow;
  Mode mode = Mode::recommended;

  /// Mode after `policy`: fused has the recommended mode only.
  [[nodiscard]] Mode mode_in_use() const {
    return policy == Policy::fused ? Mode::recommended : mode;
  }

  static void fields(auto& self, auto&& field) {
    field("policy", self.policy, "estimator whose result is returned");
    field("mode", self.mode,
          "the papers' procedure or the recommended one; fused has the recommended one only");
  }
};

struct KeyframeConfig {
  bool enabled = true;
  double renew_at_flow_ratio = 0.1;
  double renew_at_overlap = 0.6;
  int give_up_after = 5;

  static void fields(auto& self, auto&& field) {
    field("enabled", self.enabled, "align to a keyframe instead of the previous frame");
    field("renew_at_flow_ratio", self.renew_at_flow_ratio, kPositive,
          "mean flow since the keyframe above which it is replaced, in image widths");
    field("renew_at_overlap", self.renew_at_overlap, Range{0.1, 1.0},
          "ratio of the keyframe's tiles in view below which it is replaced");
    field("give_up_after", self.give_up_after, Range{1, 1000},
          "consecutive failed alignments after which it is replaced, at the predicted pose");
  }
};

/// Acceptance limits of an alignment.
struct TrustConfig {
  int min_windows = 12;
  double min_inlier_ratio = 0.4;
  double min_correlation = 0.5;
  double min_found_correlation = 0.75;
  double max_deviation_px = 0.12;
  double max_deviation_ratio = 0.025;
  double rigid_correlation = 0.975;
  double max_last_update_px = 1.0;
  double max_condition = 1e7;
  double min_ground_ratio = 0.1;
  double max_gap_s = 1.0;

  static void fields(auto& self, auto&& field) {
    field("min_windows", self.min_windows, Range{1, 100000}, "minimum number of textured tiles");
    field("min_inlier_ratio", self.min_inlier_ratio, Range{0, 1},
          "minimum mean robust weight of those tiles");
    field("min_correlation", self.min_correlation, Range{-1, 1},
          "minimum correlation of the aligned images");
    field("min_found_correlation", self.min_found_correlation, Range{-1, 1},
          "minimum correlation of images aligned from a search instead of the prediction");
    field("max_deviation_px", self.max_deviation_px, kPositive,
          "maximum deviation of the tiles from one rigid motion, beyond noise, without flow");
    field("max_deviation_ratio", self.max_deviation_ratio, kNonNegative,
          "additional maximum deviation per pixel of mean flow since the keyframe");
    field("rigid_correlation", self.rigid_correlation, Range{-1, 1},
          "correlation of the aligned images above which the deviation is not limited");
    field("max_last_update_px", self.max_last_update_px, kPositive,
          "maximum rms displacement of the tiles in the last iteration");
    field("max_condition", self.max_condition, Range{.min = 1},
          "maximum condition number of the scaled information matrix");
    field("min_ground_ratio", self.min_ground_ratio, Range{0, 1},
          "minimum ratio of tiles below the horizon");
    field("max_gap_s", self.max_gap_s, kPositive,
          "maximum time without a measurement before the velocity is reset");
  }
};

/// Measurement noise of other sensors.
struct SensorConfig {
  double gyro_sigma_rad_s = 0.005;
  double gyro_bias_sigma_rad_s = 0.1;
  double height_sigma_m = 0.1;
  double attitude_sigma_rad = 0.01;
  double start_height_sigma_ratio = 0.05;
  double accel_bias_sigma_m_s2 = 0.2;
  double camera_rotation_sigma_rad = 0.02;
  double lever_arm_sigma_m = 0.05;
  double time_offset_sigma_s = 0.03;

  static void fields(auto& self, auto&& field) {
    field("gyro_sigma_rad_s", self.gyro_sigma_rad_s, Range{1e-9, 1e9},
          "standard deviation of a mean angular rate without its bias");
    field("gyro_bias_sigma_rad_s", self.gyro_bias_sigma_rad_s, Range{0, 1},
          "standard deviation of the gyroscope's initial bias; it is estimated by the images");
    field("height_sigma_m", self.height_sigma_m, Range{1e-9, 1e9},
          "standard deviation of a height");
    field("attitude_sigma_rad", self.attitude_sigma_rad, Range{1e-9, 1e9},
          "standard deviation of roll and pitch");
    field("start_height_sigma_ratio", self.start_height_sigma_ratio, Range{1e-9, 1e9},
          "relative standard deviation of the initial height, once a sensor or, for "
          "fusion.solver: window, the IMU measures it; the window ignores a height above 0.3");
    field("accel_bias_sigma_m_s2", self.accel_bias_sigma_m_s2, Range{1e-6, 10},
          "standard deviation of the accelerometer's initial bias, for fusion.solver: window");
    field("camera_rotation_sigma_rad", self.camera_rotation_sigma_rad, Range{1e-6, 1},
          "standard deviation of the camera's mount relative to the IMU, per axis, for "
          "fusion.solver: window");
    field("lever_arm_sigma_m", self.lever_arm_sigma_m, Range{1e-6, 10},
          "standard deviation of the camera's position relative to the IMU, per axis, for "
          "fusion.solver: window");
    field("time_offset_sigma_s", self.time_offset_sigma_s, Range{1e-6, 1},
          "standard deviation of the images' clock relative to the IMU's, for "
          "fusion.solver: window");
  }
};

/// Configuration of a Navigator. `alignment` to `filter`: recommended flow estimator; `paper`: flow
/// paper. `reference`, `choice` and `fusion` are top-level sections of a config file, so `fields`
/// does not list them.
struct NavigatorConfig {
  double readout_s = 0;
  double lens_sigma_px = 0.2;
  double initial_tilt_sigma_rad = 0.0175;
  PlaneAlignmentConfig alignment;
  KeyframeConfig keyframes;
  LevellingConfig levelling;
  MotionFilterConfig filter;
  PaperConfig paper;
  SensorConfig sensors;
  TrustConfig trust;
  ReferenceConfig reference;
  EstimateChoiceConfig choice;
  FusionConfig fusion;

  static void fields(auto& self, auto&& field) {
    field("readout_s", self.readout_s, Range{0, 0.1},
          "rolling-shutter readout time, first to last row; 0: global shutter");
    field("lens_sigma_px", self.lens_sigma_px, Range{0, 100},
          "standard deviation of the lens calibration over the image; 0: exact (simulated)");
    field("initial_tilt_sigma_rad", self.initial_tilt_sigma_rad, Range{1e-6, 1},
          "standard deviation of the initial roll and pitch");
    field("alignment", self.alignment, "direct alignment of two images of the ground");
    field("keyframes", self.keyframes, "keyframe selection");
    field("levelling", self.levelling, "roll and pitch from the ground's normal");
    field("filter", self.filter, "Kalman filter of pose, velocity and angular rate");
    field("paper", self.paper, "procedure of the flow paper, for mode paper");
    field("sensors", self.sensors, "measurement noise of other sensors");
    field("trust", self.trust, "acceptance limits of an alignment");
  }
};

}  // namespace stillkite
