#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "geometry/angle.hpp"
#include "geometry/fields.hpp"
#include "stabilization/pid.hpp"
#include "stabilization/vehicle_limits.hpp"

namespace stillkite {

enum class HoldMode {
  paper,        ///< the hold paper's procedure, section III's thresholds and IV
  recommended,  ///< PI in metres with prediction, docs/hold_controller.md
};
template <>
struct EnumNames<HoldMode> {
  static constexpr auto value = std::to_array<std::pair<HoldMode, std::string_view>>(
      {{HoldMode::paper, "paper"}, {HoldMode::recommended, "recommended"}});
};

/// The paper's numbers; where it gives none, those of docs/hold_controller.md.
struct PaperHoldConfig {
  double max_angle_rad = 5 * kDegree;
  double min_shift_px = 20.0;
  double unit_translation_m = 1.0;
  PidConfig length{.proportional = 0.4, .output_limit = 0.3};
  PidConfig elevation{.proportional = 0.4, .output_limit = 0.25};
  PidConfig azimuth{.proportional = 0.4, .output_limit = 0.2};
  PidConfig yaw{.proportional = 0.5, .output_limit = 0.4};

  static void fields(auto& self, auto&& field) {
    field("max_angle_rad", self.max_angle_rad, Range{0, 3.2},
          "any Euler angle beyond this is corrected, or awaited, before translation");
    field("min_shift_px", self.min_shift_px, kNotNegative,
          "mean shift of the features up to which nothing is commanded");
    field("unit_translation_m", self.unit_translation_m, kPositive,
          "what the translation of unknown length is taken for");
    field("length", self.length, "from the tether's length error, m, to its rate, m/s");
    field("elevation", self.elevation, "from the elevation error, rad, to its rate, rad/s");
    field("azimuth", self.azimuth, "from the azimuth error, rad, to its rate, rad/s");
    field("yaw", self.yaw, "from the yaw error, rad, to its rate, rad/s");
  }
};

struct RecommendedHoldConfig {
  PidConfig position{.proportional = 4.4,
                     .integral = 2.25,
                     .dead_band = 0.02,
                     .integral_limit = 0.35,
                     .output_limit = 10.0};
  PidConfig yaw{.proportional = 1.5, .dead_band = 1 * kDegree, .output_limit = 0.4};
  double max_yaw_rad = 20 * kDegree;
  double nominal_depth_m = 4.0;
  double max_displacement_m = 0.5;
  double state_feedback_pole_1_s = 3.0;
  bool predict = true;
  double lag_s = 0.5;
  double damped_within_m = 0.5;
  double overhead_horizon_s = 8.0;
  double drift_memory_s = 2.0;

  static void fields(auto& self, auto&& field) {
    field("position", self.position,
          "from the predicted way home, m, to a velocity, m/s, along each axis of the station");
    field("yaw", self.yaw, "from the predicted turn home, rad, to its rate, rad/s");
    field("max_yaw_rad", self.max_yaw_rad, Range{0, 3.2},
          "a yaw beyond this is corrected before translation");
    field(
        "nominal_depth_m", self.nominal_depth_m, kPositive,
        "distance of what the camera sees; times parallax it is a displacement of unknown length");
    field("max_displacement_m", self.max_displacement_m, kPositive,
          "a longer way home is taken for this long");
    field("state_feedback_pole_1_s", self.state_feedback_pole_1_s, Range{0, 20},
          "how fast way and velocity home decay where both are known in metres; 0: as a way alone");
    field("predict", self.predict,
          "take off the way home what the commands since the exposure have done and will do, and "
          "move the drone from where they keep it, not from where wind has blown it");
    field("lag_s", self.lag_s, Range{0, 10}, "first-order lag of the drone behind its commands");
    field("damped_within_m", self.damped_within_m, Range{0.01, 10},
          "length of the tether below which the elevation rate is damped, and level distance from "
          "the zenith within which the azimuth turns to the way ahead, or farther out if the "
          "station is fast");
    field("overhead_horizon_s", self.overhead_horizon_s, Range{0.5, 20},
          "how far ahead it looks there");
    field("drift_memory_s", self.drift_memory_s, Range{0, 60},
          "there, time constant of the mean motion that is taken to go on so long: no gust");
  }
};

struct HoldConfig {
  HoldMode mode = HoldMode::recommended;
  VehicleLimits limits;
  double max_estimate_age_s = 0.5;
  double max_predicted_sigma_m = 0.1;
  double max_tether_age_s = 0.2;
  double max_slack_m = 0.5;
  double forget_after_s = 2.0;
  PaperHoldConfig paper;
  RecommendedHoldConfig recommended;

  static void fields(auto& self, auto&& field) {
    field("mode", self.mode, "the hold paper's procedure, or PI in metres with prediction");
    field("limits", self.limits, "the vehicle's");
    field("max_estimate_age_s", self.max_estimate_age_s, kPositive,
          "an estimate whose exposure is longer ago commands nothing");
    field("max_predicted_sigma_m", self.max_predicted_sigma_m, kNotNegative,
          "where nothing is measured, a place that inertia led to is steered by while its standard "
          "deviation is below that");
    field("max_tether_age_s", self.max_tether_age_s, kPositive,
          "with a tether reading older than this nothing is commanded");
    field("max_slack_m", self.max_slack_m, kNotNegative,
          "so much more the reel may pay out while the tether is slack; mode paper waits instead");
    field("forget_after_s", self.forget_after_s, kNotNegative,
          "after so long without position control the integrals are dropped");
    field("paper", self.paper, "mode paper");
    field("recommended", self.recommended, "mode recommended");
  }
};

/// The same for a drone that does not obey, as in a recording: without the integrals and the
/// prediction, which take the way that the drone goes for an answer to the commands.
[[nodiscard]] HoldConfig in_the_shadow(const HoldConfig& config);

}  // namespace stillkite
