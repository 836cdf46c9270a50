#include "simulation/hover/yaw_kicks.hpp"

#include <algorithm>

#include "geometry/angle.hpp"
#include "simulation/random.hpp"

namespace stillkite {
namespace {

// Completed fraction of a kick at `t_s`.
double completed_ratio(const YawKick& kick, double t_s) {
  if (kick.duration_s <= 0) return t_s >= kick.at_s ? 1 : 0;
  return std::clamp((t_s - kick.at_s) / kick.duration_s, 0.0, 1.0);
}

}  // namespace

std::vector<YawKick> make_yaw_kicks(const YawKickConfig& config, double duration_s,
                                    std::uint64_t seed) {
  if (config.smallest_deg > config.largest_deg) {
    throw InputError("yaw_kicks.smallest_deg: must not exceed largest_deg");
  }
  Random random(seed);
  std::vector<YawKick> kicks;
  for (double at_s = config.every_s; at_s <= duration_s - config.every_s; at_s += config.every_s) {
    const double size_deg = random.uniform(config.smallest_deg, config.largest_deg);
    const double sign = random.uniform() < 0.5 ? -1 : 1;
    const double gust_s = random.uniform(0.3, 1) * config.longest_s;
    kicks.push_back({.at_s = at_s,
                     .duration_s = kicks.size() % 2 == 0 ? 0 : gust_s,
                     .angle_rad = sign * size_deg * kDegree});
  }
  return kicks;
}

double kick_yaw_rad(const std::vector<YawKick>& kicks, double from_s, double to_s) {
  double sum_rad = 0;
  for (const YawKick& kick : kicks) {
    sum_rad += kick.angle_rad * (completed_ratio(kick, to_s) - completed_ratio(kick, from_s));
  }
  return sum_rad;
}

}  // namespace stillkite
