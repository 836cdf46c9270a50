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
  paper,        ///< hold paper: thresholds of section III, controller of section IV
  recommended,  ///< PI or state feedback in metres with prediction, docs/hold_control.md
};
template <>
struct EnumNames<HoldMode> {
  static constexpr auto value = std::to_array<std::pair<HoldMode, std::string_view>>(
      {{HoldMode::paper, "paper"}, {HoldMode::recommended, "recommended"}});
};

/// Parameters of the hold paper; those that it does not give are from docs/hold_control.md.
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
          "maximum Euler angle for a translation command");
    field("min_shift_px", self.min_shift_px, kNonNegative,
          "dead band of the mean feature shift: no command up to it");
    field("unit_translation_m", self.unit_translation_m, kPositive,
          "length assumed for the unit translation");
    field("length", self.length, "tether length error, m, to length rate, m/s");
    field("elevation", self.elevation, "elevation error, rad, to elevation rate, rad/s");
    field("azimuth", self.azimuth, "azimuth error, rad, to azimuth rate, rad/s");
    field("yaw", self.yaw, "yaw error, rad, to yaw rate, rad/s");
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
          "predicted position error, m, to velocity, m/s, along each axis of the station");
    field("yaw", self.yaw, "predicted yaw error, rad, to yaw rate, rad/s");
    field("max_yaw_rad", self.max_yaw_rad, Range{0, 3.2},
          "maximum yaw error for a translation command");
    field("nominal_depth_m", self.nominal_depth_m, kPositive,
          "assumed scene depth; times parallax it is the length of a displacement without scale");
    field("max_displacement_m", self.max_displacement_m, kPositive,
          "limit of the position error that enters the controller");
    field("state_feedback_pole_1_s", self.state_feedback_pole_1_s, Range{0, 20},
          "double closed-loop pole of position and velocity error where both are metric; 0: PI on "
          "the position error alone");
    field(
        "predict", self.predict,
        "predict the position error over latency and lag from the commands (Smith predictor), and "
        "take the tether axes from the commands instead of the wind-deflected measurement");
    field("lag_s", self.lag_s, Range{0, 10}, "first-order lag of the drone behind its commands");
    field("damped_within_m", self.damped_within_m, Range{0.01, 10},
          "tether length below which the elevation rate is damped, and minimum horizontal distance "
          "from the zenith within which the azimuth is controlled predictively");
    field("overhead_horizon_s", self.overhead_horizon_s, Range{0.5, 20},
          "prediction horizon of the azimuth near the zenith");
    field("drift_memory_s", self.drift_memory_s, Range{0, 60},
          "time constant of the low pass on the drift for that prediction, against gusts");
  }
};

struct HoldConfig {
  HoldMode mode = HoldMode::recommended;
  VehicleLimits limits;
  double max_estimate_age_s = 0.5;
  double max_predicted_sigma_m = 0.1;
  double max_tether_age_s = 0.2;
  double max_slack_m = 0.5;
  double reset_integral_after_s = 2.0;
  PaperHoldConfig paper;
  RecommendedHoldConfig recommended;

  static void fields(auto& self, auto&& field) {
    field("mode", self.mode, "the hold paper's procedure, or PI in metres with prediction");
    field("limits", self.limits, "limits of the vehicle");
    field("max_estimate_age_s", self.max_estimate_age_s, kPositive,
          "maximum age of an estimate since its exposure");
    field("max_predicted_sigma_m", self.max_predicted_sigma_m, kNonNegative,
          "maximum standard deviation of an inertially predicted position for control without an "
          "image measurement");
    field("max_tether_age_s", self.max_tether_age_s, kPositive, "maximum age of a tether reading");
    field("max_slack_m", self.max_slack_m, kNonNegative,
          "maximum length paid out while the tether is slack; mode paper holds instead");
    field("reset_integral_after_s", self.reset_integral_after_s, kNonNegative,
          "time without position control after which the integrals are reset");
    field("paper", self.paper, "mode paper");
    field("recommended", self.recommended, "mode recommended");
  }
};

/// Configuration for a drone that does not execute the commands, as in a recording. Integrals and
/// prediction are off, since both attribute the drone's motion to the commands.
[[nodiscard]] HoldConfig in_shadow_mode(const HoldConfig& config);

}  // namespace stillkite
