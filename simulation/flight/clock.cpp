#include "simulation/flight/clock.hpp"

#include <algorithm>
#include <cmath>

#include "simulation/random.hpp"

namespace stillkite {
namespace {

Timestamp rounded(Timestamp exact, double resolution_s) {
  const std::int64_t step_ns = from_seconds(resolution_s).ns;
  if (step_ns <= 1) return exact;
  return {std::llround(static_cast<double>(exact.ns) / static_cast<double>(step_ns)) * step_ns};
}

}  // namespace

std::vector<Timestamp> image_stamps(const ClockConfig& config,
                                    const std::vector<Timestamp>& exposures, std::uint64_t seed) {
  if (config.has_exact_image_stamps()) return exposures;
  constexpr std::int64_t kMinSpacing_ns = 1'000'000;
  const std::int64_t min_step_ns = std::max<std::int64_t>(1, from_seconds(config.rounding_s).ns);
  Random random(seed);
  std::vector<Timestamp> stamps;
  stamps.reserve(exposures.size());
  Timestamp last_arrival{exposures.empty() ? 0 : exposures.front().ns - kMinSpacing_ns};
  for (const Timestamp exposure : exposures) {
    const double latency_s =
        config.image_delay_s - config.jitter_s * std::log(1.0 - random.uniform());
    last_arrival.ns =
        std::max(exposure.ns + from_seconds(latency_s).ns, last_arrival.ns + kMinSpacing_ns);
    Timestamp stamp = rounded(last_arrival, config.rounding_s);
    if (!stamps.empty()) stamp.ns = std::max(stamp.ns, stamps.back().ns + min_step_ns);
    stamps.push_back(stamp);
  }
  return stamps;
}

Timestamp imu_stamp(const ClockConfig& config, Timestamp exact) {
  const double skew_ns = 1e-6 * config.imu_skew_ppm * static_cast<double>(exact.ns);
  const Timestamp on_imu_clock{exact.ns + from_seconds(config.imu_offset_s).ns +
                               std::llround(skew_ns)};
  return rounded(on_imu_clock, config.rounding_s);
}

}  // namespace stillkite
