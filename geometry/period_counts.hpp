#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/time.hpp"

namespace stillkite {

/// Interval in a burst over the frame period, at most: below that of a doubled frame rate, 0.5.
inline constexpr double kMaxBurstRatio = 0.4;

/// Number of periods from each of several stamps to the next: more than one after missed frames.
///
/// A late stamp follows no missed frame, as one of the next four stamps is on time: delays of 8 ms
/// on average at 30 Hz exceed half a period in 13 % of the frames, five in a row in 3e-5. In a
/// burst all stamps but the last are late: no evidence of the period.
class PeriodCounts {
 public:
  PeriodCounts(std::span<const Timestamp> stamps, double period_s, bool is_last_late);

  /// Periods to stamp i from the one before.
  [[nodiscard]] double operator[](std::size_t i) const { return counts_[i]; }
  [[nodiscard]] bool is_late(std::size_t i) const { return is_late_[i]; }
  /// Number of stamps on time among the first ones.
  [[nodiscard]] std::size_t on_time(std::size_t stamps) const;
  /// Variance of the last count: a Bernoulli variable, late or after missed frames, with the rate
  /// of the late stamps.
  [[nodiscard]] double last_variance() const;

 private:
  void count_all();
  void add_lateness(double periods);
  [[nodiscard]] double count_to(std::size_t i, double before_s);
  [[nodiscard]] bool may_be_late(double periods) const;
  [[nodiscard]] double at_s(std::size_t i) const { return seconds_between(stamps_[0], stamps_[i]); }

  std::span<const Timestamp> stamps_;
  double period_s_;
  std::vector<double> counts_;
  std::vector<bool> is_late_;
  int late_ = 0, missed_ = 0;
  double max_lateness_ = 0;  // periods
  double last_excess_ = 0;   // periods beyond one, by the last stamp alone
};

}  // namespace stillkite
