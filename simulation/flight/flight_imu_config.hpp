#pragma once

#include <cmath>

#include "simulation/flight/sensors.hpp"

namespace stillkite {

/// IMU of a free flight and its transmission.
struct FlightImuConfig : ImuConfig {
  double gap_s = 0;
  double gap_every_s = 10;
  bool removes_gravity = false;

  static void fields(auto& self, auto&& field) {
    ImuConfig::fields(self, field);
    field("gap_s", self.gap_s, kNonNegative, "length of a gap in the readings; 0: no gaps");
    field("gap_every_s", self.gap_every_s, kPositive, "time from one gap's begin to the next's");
    field("removes_gravity", self.removes_gravity,
          "true: acceleration of the body instead of specific force, as after a device's filter");
  }

  /// Gaps begin at the multiples of `gap_every_s` above 0.
  [[nodiscard]] bool is_in_gap(double t_s) const {
    constexpr double kRounding_s = 1e-9;
    const double now_s = t_s + kRounding_s;
    return gap_s > 0 && now_s >= gap_every_s && std::fmod(now_s, gap_every_s) < gap_s;
  }
};

}  // namespace stillkite
