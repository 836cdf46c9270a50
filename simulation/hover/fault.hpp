#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

enum class FaultKind {
  frozen_video,            ///< the last image again, with new stamps
  every_third_frame_lost,  ///< on the way to the ground
  stamps_off,              ///< images say they are later than they are
  picture_dark,            ///< hardly any light: there is nothing to see but noise
  reference_blind,         ///< something patterned swings before the upper part of the image
  flow_blind,              ///< the floor swings, as water or what the wind blows over it
  height_step,             ///< the floor is higher than before, what stands on it is not
  gyro_bias,               ///< about each axis; the IMU's own heading turns with it
  tether_slack,            ///< the reel pays out too much, and the drone comes nearer
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

/// One fault of a trial. Of the amounts only that of its kind counts.
struct FaultConfig {
  FaultKind kind = FaultKind::frozen_video;
  double start_s = 10;
  double duration_s = 3;
  double stamps_off_s = 0.05;
  double light_ratio = 0.005;
  double covered_ratio = 0.75;
  double floor_swing_m = 0.2;
  double floor_rise_m = 0.3;
  double gyro_bias_deg_s = 1;
  double loose_tether_m = 0.15;
  double loosening_m_s = 0.3;

  static void fields(auto& self, auto&& field) {
    field("kind", self.kind, "what goes wrong");
    field("start_s", self.start_s, kNotNegative, "since the trial's beginning");
    field("duration_s", self.duration_s, kNotNegative, "until all is well again");
    field("stamps_off_s", self.stamps_off_s, Range{-1, 1}, "stamps_off: added to a stamp");
    field("light_ratio", self.light_ratio, Range{0, 1}, "picture_dark: of the light that is left");
    field("covered_ratio", self.covered_ratio, Range{0, 1},
          "reference_blind: of the image's height, from above");
    field("floor_swing_m", self.floor_swing_m, Range{0, 5},
          "flow_blind: how far to either side, every 2 s");
    field("floor_rise_m", self.floor_rise_m, Range{-5, 5}, "height_step: how much higher");
    field("gyro_bias_deg_s", self.gyro_bias_deg_s, Range{-100, 100}, "gyro_bias: about each axis");
    field("loose_tether_m", self.loose_tether_m, Range{0, 10},
          "tether_slack: by which the drone is nearer than the paid-out length says");
    field("loosening_m_s", self.loosening_m_s, kPositive,
          "tether_slack: how fast the tether becomes loose and taut again");
  }
};

/// What is wrong at an instant; as it stands, nothing.
struct FaultEffect {
  bool is_video_frozen = false;
  bool is_every_third_frame_lost = false;
  double stamps_off_s = 0;
  double light_ratio = 1;
  double covered_ratio = 0;
  Eigen::Vector3d floor_moved_m = Eigen::Vector3d::Zero();  ///< world
  double gyro_bias_rad_s = 0;                               ///< about each axis of the body
  double heading_error_rad = 0;  ///< of the IMU's attitude: what the bias has added up to; it stays
  double loose_tether_m = 0;
};

/// A fault lasts from its start on, for less than its duration.
[[nodiscard]] FaultEffect effect_of(const FaultConfig& fault, double t_s);

}  // namespace stillkite
