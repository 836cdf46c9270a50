#include "evaluation/yaw_settling.hpp"

#include <cmath>

namespace stillkite {

std::optional<double> settling_time_s(const YawErrors& errors, double from_s, double until_s,
                                      double limit_rad) {
  std::optional<double> settled_at_s;  // start of the last interval within the limit
  for (std::size_t i = 0; i < errors.t_s.size(); ++i) {
    if (errors.t_s[i] < from_s || errors.t_s[i] >= until_s) continue;
    if (std::abs(errors.error_rad[i]) > limit_rad) {
      settled_at_s.reset();
    } else if (!settled_at_s) {
      settled_at_s = errors.t_s[i];
    }
  }
  if (!settled_at_s) return std::nullopt;
  return *settled_at_s - from_s;
}

}  // namespace stillkite
