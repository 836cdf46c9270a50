#include "geometry/frame_period.hpp"

#include <cstddef>
#include <numeric>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kMaxIntervals = 128;
constexpr std::size_t kMinIntervals = 16;  // a block of four
constexpr double kMaxPause_s = 1;

// Median over the blocks of `count` intervals of the mean interval.
double median_mean_s(std::span<const double> intervals_s, std::size_t count) {
  std::vector<double> means_s;
  means_s.reserve(intervals_s.size());
  double sum_s = 0;
  for (std::size_t i = 0; i < intervals_s.size(); ++i) {
    sum_s += intervals_s[i] - (i < count ? 0 : intervals_s[i - count]);
    if (i + 1 >= count) means_s.push_back(sum_s / static_cast<double>(count));
  }
  return upper_median(means_s);
}

void append(Timestamp from, Timestamp to, std::vector<double>& intervals_s) {
  const double interval_s = seconds_between(from, to);
  if (interval_s > 0 && interval_s <= kMaxPause_s) intervals_s.push_back(interval_s);
}

}  // namespace

void FramePeriod::add(Timestamp from, Timestamp to) {
  append(from, to, intervals_s_);
  if (intervals_s_.size() > kMaxIntervals) intervals_s_.erase(intervals_s_.begin());
}

double FramePeriod::with(std::span<const Timestamp> stamps) const {
  std::vector<double> intervals_s = intervals_s_;
  for (std::size_t i = 1; i < stamps.size(); ++i) append(stamps[i - 1], stamps[i], intervals_s);
  if (intervals_s.empty()) return 0;
  const double median_s = median_mean_s(intervals_s, 1);
  if (intervals_s.size() < kMinIntervals) return median_s;
  const double period_s = median_mean_s(intervals_s, intervals_s.size() / 4);
  return median_s < 0.5 * period_s ? period_s : median_s;
}

}  // namespace stillkite
