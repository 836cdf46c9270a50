#include "geometry/period_counts.hpp"

#include <cmath>
#include <optional>

#include "geometry/time_filter.hpp"

namespace stillkite {

PeriodCounts::PeriodCounts(std::span<const Timestamp> stamps, double period_s, bool is_last_late)
    : stamps_(stamps), period_s_(period_s), counts_(stamps.size(), 1) {
  for (std::size_t i = 0; i + 1 < stamps.size(); ++i) {
    is_late_.push_back(at_s(i + 1) - at_s(i) < kMaxBurstRatio * period_s_);
  }
  is_late_.push_back(is_last_late);
  count_all();
}

// Relative to a line through the stamps on time so far.
void PeriodCounts::count_all() {
  std::optional<std::size_t> first;  // on time
  std::optional<TimeFilter> line;
  for (std::size_t i = 0; i < stamps_.size(); ++i) {
    if (line && is_late_[i]) {
      add_lateness((at_s(i) - line->time_s()) / period_s_ - 1);
    } else if (line) {
      counts_[i] = count_to(i, line->time_s());
    } else if (first && !is_late_[i]) {
      const double late = static_cast<double>(i - *first) - 1;
      counts_[i] = count_to(i, at_s(*first) + late * period_s_);
      line.emplace(VarianceRatio{.interval = 0, .jitter = 1}, at_s(*first), at_s(i),
                   late + counts_[i]);
      continue;
    } else if (!is_late_[i]) {
      first = i;
    }
    if (line) is_late_[i] ? line->predict(1) : line->update(at_s(i), counts_[i]);
  }
}

std::size_t PeriodCounts::on_time(std::size_t stamps) const {
  const auto end = is_late_.begin() + static_cast<std::ptrdiff_t>(stamps);
  return static_cast<std::size_t>(std::count(is_late_.begin(), end, false));
}

double PeriodCounts::last_variance() const {
  if (!may_be_late(last_excess_)) return 0;
  const double late = (late_ + 1.0) / (late_ + missed_ + 2.0);
  return late * (1 - late) * last_excess_ * last_excess_;
}

void PeriodCounts::add_lateness(double periods) {
  max_lateness_ = std::max(max_lateness_, std::round(periods));
  if (periods > 0.5) ++late_;
}

double PeriodCounts::count_to(std::size_t i, double before_s) {
  constexpr std::size_t kNext = 4;
  const auto count = [&](std::size_t j) {
    const double periods = (at_s(j) - before_s) / period_s_;
    return std::max(1.0, std::round(periods) - static_cast<double>(j - i));
  };
  const double first = count(i);
  last_excess_ = first - 1;
  if (i + 1 == stamps_.size()) {
    is_late_[i] = may_be_late(last_excess_) && late_ > missed_;
    return is_late_[i] ? 1 : first;
  }
  double least = first;
  const std::size_t end = std::min(i + 1 + kNext, stamps_.size());
  for (std::size_t j = i + 1; j < end; ++j) least = std::min(least, count(j));
  if (first > 1) ++(least < first ? late_ : missed_);
  max_lateness_ = std::max(max_lateness_, first - least);
  return least;
}

// True for an excess over one period that a late stamp has reached.
bool PeriodCounts::may_be_late(double periods) const {
  return periods > 0 && periods <= max_lateness_;
}

}  // namespace stillkite
