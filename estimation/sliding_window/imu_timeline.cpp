#include "estimation/sliding_window/imu_timeline.hpp"

#include <algorithm>

namespace stillkite {
namespace {

// A hole between two readings that is due to rounding.
constexpr double kRounding_s = 1e-6;

auto first_after(const std::vector<ImuInterval>& readings, Timestamp stamp) {
  return std::upper_bound(
      readings.begin(), readings.end(), stamp,
      [](Timestamp from, const ImuInterval& reading) { return from < reading.to; });
}

}  // namespace

void ImuTimeline::add(std::span<const ImuInterval> readings) {
  for (ImuInterval reading : readings) {
    reading.from = std::max(reading.from, end());
    if (reading.from < reading.to) readings_.push_back(reading);
  }
}

std::vector<ImuSample> ImuTimeline::between(Timestamp from, Timestamp to) const {
  std::vector<ImuSample> samples;
  Timestamp at = from;
  const auto add = [&](const ImuInterval& reading, Timestamp end, bool is_gap) {
    const double dt_s = seconds_between(at, end);
    if (dt_s <= (is_gap ? kRounding_s : 0)) return;
    samples.push_back({.dt_s = dt_s,
                       .angular_rate_rad_s = reading.angular_rate_rad_s,
                       .specific_force_m_s2 = reading.specific_force_m_s2,
                       .is_gap = is_gap});
    at = end;
  };
  auto next = first_after(readings_, from);
  const ImuInterval* held = next == readings_.begin() ? &held_ : &*(next - 1);
  for (; next != readings_.end() && next->from < to; ++next) {
    add(*held, next->from, true);
    add(*next, std::min(next->to, to), false);
    held = &*next;
  }
  add(*held, to, true);
  return samples;
}

const ImuInterval& ImuTimeline::at(Timestamp stamp) const {
  const auto next = first_after(readings_, stamp);
  if (next != readings_.end() && next->from < stamp) return *next;
  return next == readings_.begin() ? held_ : *(next - 1);
}

void ImuTimeline::forget_before(Timestamp stamp) {
  const auto kept = first_after(readings_, stamp);
  if (kept == readings_.begin()) return;
  held_ = *(kept - 1);
  readings_.erase(readings_.begin(), kept);
}

}  // namespace stillkite
