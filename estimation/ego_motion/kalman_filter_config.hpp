#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

/// Measurement variance: configured (flow paper) or estimated by the least squares.
enum class MeasurementVariance { fixed, measured };

template <>
struct EnumNames<MeasurementVariance> {
  static constexpr auto value = std::to_array<std::pair<MeasurementVariance, std::string_view>>(
      {{MeasurementVariance::fixed, "fixed"}, {MeasurementVariance::measured, "measured"}});
};

/// Six scalar Kalman filters, one per velocity component. Defaults: flow paper, section 5.1;
/// process noise per step.
struct KalmanFilterConfig {
  MeasurementVariance variance = MeasurementVariance::fixed;
  double velocity_sigma_m_s = 0.3;
  double angular_rate_sigma_rad_s = 0.00015;
  double velocity_process_sigma_m_s = 0.1;
  double angular_rate_process_sigma_rad_s = 0.017;

  static void fields(auto& self, auto&& field) {
    field("variance", self.variance,
          "measurement variance: configured below, or estimated per frame");
    field("velocity_sigma_m_s", self.velocity_sigma_m_s, Range{1e-9, 1e9},
          "standard deviation of a velocity measurement, per axis");
    field("angular_rate_sigma_rad_s", self.angular_rate_sigma_rad_s, Range{1e-9, 1e9},
          "standard deviation of an angular rate measurement, per axis");
    field("velocity_process_sigma_m_s", self.velocity_process_sigma_m_s, Range{0, 1e9},
          "standard deviation of the velocity change per step, per axis");
    field("angular_rate_process_sigma_rad_s", self.angular_rate_process_sigma_rad_s, Range{0, 1e9},
          "standard deviation of the angular rate change per step, per axis");
  }
};

}  // namespace stillkite
