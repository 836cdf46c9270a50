#pragma once

#include <cstdint>
#include <vector>

#include "geometry/fields.hpp"

namespace stillkite {

/// Yaw disturbance with constant rate over its duration; 0 s: a step.
struct YawKick {
  double at_s = 0;
  double duration_s = 0;
  double angle_rad = 0;  ///< left is +
};

struct YawKickConfig {
  double every_s = 12;
  double largest_deg = 20;
  double smallest_deg = 5;
  double longest_s = 1.5;

  static void fields(auto& self, auto&& field) {
    field("every_s", self.every_s, Range{.min = 0.1}, "interval between kicks");
    field("largest_deg", self.largest_deg, Range{0, 180}, "maximum magnitude of a kick");
    field("smallest_deg", self.smallest_deg, Range{0, 180}, "minimum magnitude of a kick");
    field("longest_s", self.longest_s, kNonNegative,
          "maximum duration of a gust; every other kick is a step");
  }
};

/// Alternating steps and gusts with random angles, from one interval after the start to one
/// interval before the end. Throws InputError if smallest_deg > largest_deg.
[[nodiscard]] std::vector<YawKick> make_yaw_kicks(const YawKickConfig& config, double duration_s,
                                                  std::uint64_t seed);

/// Yaw change by the kicks in (from_s, to_s], in rad.
[[nodiscard]] double kick_yaw_rad(const std::vector<YawKick>& kicks, double from_s, double to_s);

}  // namespace stillkite
