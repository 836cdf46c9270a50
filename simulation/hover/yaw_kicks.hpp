#pragma once

#include <cstdint>
#include <vector>

#include "geometry/fields.hpp"

namespace stillkite {

/// Turns the drone by an angle, evenly over a duration; 0 s is a step.
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
    field("every_s", self.every_s, Range{.min = 0.1}, "time between kicks");
    field("largest_deg", self.largest_deg, Range{0, 180}, "of a kick, to either side");
    field("smallest_deg", self.smallest_deg, Range{0, 180}, "of a kick");
    field("longest_s", self.longest_s, kNotNegative, "a gust; every other kick is a step");
  }
};

/// Steps and gusts in turn, the first after one interval and none later than that before the end.
/// Throws InputError where the smallest is larger than the largest.
[[nodiscard]] std::vector<YawKick> make_yaw_kicks(const YawKickConfig& config, double duration_s,
                                                  std::uint64_t seed);

/// By how much the kicks turn the drone in (from_s, to_s].
[[nodiscard]] double kicked_between_rad(const std::vector<YawKick>& kicks, double from_s,
                                        double to_s);

}  // namespace stillkite
