#include "io/dataset/interpolation_noise.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {

InterpolationNoise interpolation_noise(const TimeSeries<Eigen::Vector3d>& readings,
                                       double density) {
  const std::optional<double> interval_s = median_interval_s(readings.stamps);
  if (!interval_s || *interval_s * kMinImuRate_hz <= 1) return {};
  double sum = 0;
  int count = 0;
  for (std::size_t i = 2; i < readings.stamps.size(); ++i) {
    const bool has_gap =
        seconds_between(readings.stamps[i - 2], readings.stamps[i - 1]) > readings.max_gap_s ||
        seconds_between(readings.stamps[i - 1], readings.stamps[i]) > readings.max_gap_s;
    if (has_gap) continue;
    const Eigen::Vector3d difference =
        readings.values[i - 2] - 2 * readings.values[i - 1] + readings.values[i];
    sum += difference.squaredNorm() / 3;
    ++count;
  }
  if (count == 0) return {};
  const double T = *interval_s;
  const double step_variance = std::max(0.0, sum / count - 6 * density * density / T) / 2;  // S T
  return {.sigma = std::sqrt(step_variance / 6), .density = std::sqrt(step_variance * T / 12)};
}

}  // namespace stillkite
