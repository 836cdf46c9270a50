#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

enum class FaultKind {
  frozen_video,            ///< repeated image with new stamps
  every_third_frame_lost,  ///< frame loss of the video link
  stamps_off,              ///< constant error of the image stamps
  picture_dark,            ///< almost no light: noise only
  reference_blind,         ///< moving patterned occlusion of the upper part of the image
  flow_blind,              ///< oscillating floor texture, like water or blowing dust
  height_step,             ///< step of the floor height; objects on the floor stay
  gyro_bias,               ///< step on each axis; integrates into the IMU's heading
  tether_slack,            ///< excess tether length: the drone is nearer than the length
};
template <>
struct EnumNames<FaultKind> {
  static constexpr auto value = std::to_array<std::pair<FaultKind, std::string_view>>(
      {{FaultKind::frozen_video, "frozen_video"},
       {FaultKind::every_third_frame_lost, "every_third_frame_lost"},
       {FaultKind::stamps_off, "stamps_off"},
       {FaultKind::picture_dark, "picture_dark"},
       {FaultKind::reference_blind, "reference_blind"},
       {FaultKind::flow_blind, "flow_blind"},
       {FaultKind::height_step, "height_step"},
       {FaultKind::gyro_bias, "gyro_bias"},
       {FaultKind::tether_slack, "tether_slack"}});
};

/// One fault of a trial. Each amount applies to its own kind only.
struct FaultConfig {
  FaultKind kind = FaultKind::frozen_video;
  double start_s = 10;
  double duration_s = 3;
  double stamp_offset_s = 0.05;
  double light_ratio = 0.005;
  double covered_ratio = 0.75;
  double floor_swing_m = 0.2;
  double floor_rise_m = 0.3;
  double gyro_bias_deg_s = 1;
  double loose_tether_m = 0.15;
  double loosening_m_s = 0.3;

  static void fields(auto& self, auto&& field) {
    field("kind", self.kind, "kind of the fault");
    field("start_s", self.start_s, kNonNegative, "onset after the start of the trial");
    field("duration_s", self.duration_s, kNonNegative, "duration of the fault");
    field("stamp_offset_s", self.stamp_offset_s, Range{-1, 1},
          "stamps_off: offset added to the image stamps");
    field("light_ratio", self.light_ratio, Range{0, 1},
          "picture_dark: remaining fraction of the light");
    field("covered_ratio", self.covered_ratio, Range{0, 1},
          "reference_blind: occluded fraction of the image height, from the top");
    field("floor_swing_m", self.floor_swing_m, Range{0, 5},
          "flow_blind: amplitude of the horizontal floor motion, period 2 s");
    field("floor_rise_m", self.floor_rise_m, Range{-5, 5}, "height_step: rise of the floor");
    field("gyro_bias_deg_s", self.gyro_bias_deg_s, Range{-100, 100},
          "gyro_bias: additional bias on each axis");
    field("loose_tether_m", self.loose_tether_m, Range{0, 10},
          "tether_slack: tether length minus distance to the drone");
    field("loosening_m_s", self.loosening_m_s, kPositive,
          "tether_slack: rate at which the slack builds up and disappears");
  }
};

/// Effect of a fault at one instant. Default: no fault.
struct FaultEffect {
  bool is_video_frozen = false;
  bool is_every_third_frame_lost = false;
  double stamp_offset_s = 0;
  double light_ratio = 1;
  double covered_ratio = 0;
  Eigen::Vector3d floor_displacement_m = Eigen::Vector3d::Zero();  ///< world frame
  double gyro_bias_rad_s = 0;                                      ///< on each body axis
  double heading_error_rad = 0;  ///< integral of the bias, in the IMU's attitude; permanent
  double loose_tether_m = 0;
};

/// Effect at `t_s`. A fault is active in [start, start + duration).
[[nodiscard]] FaultEffect effect_of(const FaultConfig& fault, double t_s);

}  // namespace stillkite
