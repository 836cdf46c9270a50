#pragma once

#include "estimation/ego_motion/motion_filter.hpp"
#include "estimation/fusion/fusion_config.hpp"
#include "estimation/plane/keyframe_pose.hpp"
#include "estimation/plane/plane_alignment.hpp"
#include "geometry/fields.hpp"
#include "navigation/paper_config.hpp"
#include "navigation/reference_config.hpp"
#include "stabilization/estimate_choice.hpp"

namespace stillkite {

/// How the motion is found: as in the papers, or by what we recommend beyond them.
enum class Mode { paper, recommended };
template <>
struct EnumNames<Mode> {
  static constexpr auto value = std::to_array<std::pair<Mode, std::string_view>>(
      {{Mode::paper, "paper"}, {Mode::recommended, "recommended"}});
};

/// Which estimator's motion is the answer.
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

  /// The fusion has but one.
  [[nodiscard]] Mode mode_in_use() const {
    return policy == Policy::fused ? Mode::recommended : mode;
  }

  static void fields(auto& self, auto&& field) {
    field("policy", self.policy, "whose motion is the answer");
    field("mode", self.mode, "the papers' own steps, or ours; fused knows ours alone");
  }
};

struct KeyframeConfig {
  bool enabled = true;
  double renew_at_flow_ratio = 0.1;
  double renew_at_overlap = 0.6;
  int give_up_after = 5;

  static void fields(auto& self, auto&& field) {
    field("enabled", self.enabled, "align to a keyframe, not to the last frame");
    field("renew_at_flow_ratio", self.renew_at_flow_ratio, kPositive,
          "mean flow from the keyframe, in image widths, at which a new one is taken");
    field("renew_at_overlap", self.renew_at_overlap, Range{0.1, 1.0},
          "share of the keyframe's windows still in view below which a new one is taken");
    field("give_up_after", self.give_up_after, Range{1, 1000},
          "frames in a row that do not align to it, after which a new one is taken as predicted");
  }
};

/// When an alignment is not to be trusted.
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
    field("min_windows", self.min_windows, Range{1, 100000}, "windows with texture");
    field("min_inlier_ratio", self.min_inlier_ratio, Range{0, 1}, "weight kept by those windows");
    field("min_correlation", self.min_correlation, Range{-1, 1}, "of the aligned images");
    field("min_found_correlation", self.min_found_correlation, Range{-1, 1},
          "of images aligned from a place that was searched, not foretold: who tries often errs");
    field("max_deviation_px", self.max_deviation_px, kPositive,
          "of the windows from the one motion, beyond the noise, however little has moved");
    field("max_deviation_ratio", self.max_deviation_ratio, kNotNegative,
          "the same, for every pixel of mean flow since the keyframe");
    field("rigid_correlation", self.rigid_correlation, Range{-1, 1},
          "of the aligned images, from which on windows may deviate: the ground is rigid");
    field("max_last_update_px", self.max_last_update_px, kPositive,
          "change of the windows' places in the last step, rms");
    field("max_condition", self.max_condition, Range{.min = 1}, "of the scaled information");
    field("min_ground_ratio", self.min_ground_ratio, Range{0, 1}, "windows below the horizon");
    field("max_gap_s", self.max_gap_s, kPositive,
          "without a measurement, longest to trust the last speed");
  }
};

/// How well other sensors know what they say, where there are any.
struct SensorConfig {
  double gyro_sigma_rad_s = 0.005;
  double height_sigma_m = 0.1;
  double attitude_sigma_rad = 0.01;
  double start_height_sigma_ratio = 0.05;

  static void fields(auto& self, auto&& field) {
    field("gyro_sigma_rad_s", self.gyro_sigma_rad_s, Range{1e-9, 1e9},
          "of a mean angular rate, bias included");
    field("height_sigma_m", self.height_sigma_m, Range{1e-9, 1e9}, "of a height");
    field("attitude_sigma_rad", self.attitude_sigma_rad, Range{1e-9, 1e9}, "of a roll or pitch");
    field("start_height_sigma_ratio", self.start_height_sigma_ratio, Range{1e-9, 1e9},
          "of the height at the start, once a sensor measures it too");
  }
};

/// Everything a navigator can be told. `alignment` to `filter` are the recommended flow's, `paper`
/// is the flow paper's. The keys of the reference estimator, of the choice and of the fusion are
/// listed beside these, not among them.
struct NavigatorConfig {
  double readout_s = 0;
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
          "time from the first row's exposure to the last row's; 0: global shutter");
    field("initial_tilt_sigma_rad", self.initial_tilt_sigma_rad, Range{1e-6, 1},
          "how well roll and pitch are known at the start, as a standard deviation");
    field("alignment", self.alignment, "direct alignment of two images of the ground");
    field("keyframes", self.keyframes, "what an image is aligned to");
    field("levelling", self.levelling, "roll and pitch from the ground's normal");
    field("filter", self.filter, "Kalman filter of pose, velocity and angular rate");
    field("paper", self.paper, "the flow paper's own steps, in its mode");
    field("sensors", self.sensors, "other sensors' standard deviations");
    field("trust", self.trust, "limits beyond which a frame's answer is not used");
  }
};

}  // namespace stillkite
