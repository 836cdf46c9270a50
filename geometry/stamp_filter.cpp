#include "geometry/stamp_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "geometry/median.hpp"
#include "geometry/time_filter.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kWindow = 128;
constexpr std::size_t kMinStamps = 3;  // two determine time and period
// White jitter correlates neighbouring intervals by -1/2, irregular intervals by 0. The difference
// is two standard errors of 16 intervals.
constexpr std::size_t kMinSmoothed = 17;

// The time constant of a filter is 1 / sqrt(ratio) frames, from the window's length to below one.
constexpr auto kRatios = std::to_array<VarianceRatio>(
    {{0, 1}, {1e-4, 1}, {1e-3, 1}, {1e-2, 1}, {0.1, 1}, {1, 1}, {10, 1}, {1, 0}});

double square(double x) {
  return x * x;
}

double median_interval_s(std::span<const Timestamp> stamps) {
  std::vector<double> intervals_s;
  intervals_s.reserve(kWindow);
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    intervals_s.push_back(seconds_between(stamps[i - 1], stamps[i]));
  }
  return upper_median(intervals_s);
}

// True if the intervals agree within a thousandth.
bool is_regular(std::span<const Timestamp> stamps) {
  constexpr double kMaxRatio = 1e-3;
  double least_s = seconds_between(stamps[0], stamps[1]), most_s = least_s;
  for (std::size_t i = 2; i < stamps.size(); ++i) {
    const double interval_s = seconds_between(stamps[i - 1], stamps[i]);
    least_s = std::min(least_s, interval_s);
    most_s = std::max(most_s, interval_s);
  }
  return most_s - least_s < kMaxRatio * least_s;
}

// Number of periods from each stamp of a window to the next: more than one after missed frames. A
// single late stamp follows no missed frame, as one of the next four stamps is on time. Delays of 8
// ms on average at 30 Hz exceed half a period in 13 % of the frames, five in a row in 3e-5.
class PeriodCounts {
 public:
  explicit PeriodCounts(std::span<const Timestamp> stamps)
      : stamps_(stamps), median_s_(median_interval_s(stamps)) {
    const double first_s = at_s(1);
    counts_.push_back(std::max(1.0, std::round(first_s / median_s_)));
    TimeFilter regular(kRatios[0], first_s, counts_.back());
    for (std::size_t i = 2; i < stamps.size(); ++i) {
      counts_.push_back(count_to(i, regular));
      regular.update(at_s(i), counts_.back());
    }
  }

  [[nodiscard]] double operator[](std::size_t i) const { return counts_[i]; }

  // Variance of the last count: a Bernoulli variable, late or after missed frames, with the rate of
  // the late stamps in the window.
  [[nodiscard]] double last_variance() const {
    if (!may_be_late(last_excess_)) return 0;
    const double late = (late_ + 1.0) / (late_ + missed_ + 2.0);
    return late * (1 - late) * square(last_excess_);
  }

 private:
  [[nodiscard]] double at_s(std::size_t i) const { return seconds_between(stamps_[0], stamps_[i]); }

  double count_to(std::size_t i, const TimeFilter& regular) {
    constexpr std::size_t kNext = 4;
    const auto count = [&](std::size_t j) {
      const double periods = (at_s(j) - regular.time_s()) / median_s_;
      return std::max(1.0, std::round(periods) - static_cast<double>(j - i));
    };
    const double first = count(i);
    last_excess_ = first - 1;
    if (i + 1 == stamps_.size()) {
      return may_be_late(last_excess_) && late_ > missed_ ? 1 : first;
    }
    double least = first;
    const std::size_t end = std::min(i + 1 + kNext, stamps_.size());
    for (std::size_t j = i + 1; j < end; ++j) least = std::min(least, count(j));
    if (first > 1) ++(least < first ? late_ : missed_);
    max_lateness_ = std::max(max_lateness_, first - least);
    return least;
  }

  // True for an excess over one period that a late stamp of the window has reached.
  [[nodiscard]] bool may_be_late(double periods) const {
    return periods > 0 && periods <= max_lateness_;
  }

  std::span<const Timestamp> stamps_;
  double median_s_;
  std::vector<double> counts_;
  int late_ = 0, missed_ = 0;
  double max_lateness_ = 0;  // periods
  double last_excess_ = 0;   // periods beyond one, by the last stamp alone
};

std::vector<TimeFilter> filters_of(std::span<const Timestamp> stamps, const PeriodCounts& counts) {
  std::vector<TimeFilter> filters;
  for (const VarianceRatio& ratio : kRatios) {
    TimeFilter& filter =
        filters.emplace_back(ratio, seconds_between(stamps[0], stamps[1]), counts[0]);
    for (std::size_t i = 2; i < stamps.size(); ++i) {
      filter.update(seconds_between(stamps[0], stamps[i]), counts[i - 1]);
    }
  }
  return filters;
}

// Variance of the uniform error of rounded stamps.
double rounding_variance(double resolution_s) {
  return square(resolution_s) / 12;
}

}  // namespace

StampFilter::StampFilter(double resolution_s) : resolution_s_(resolution_s) {
  reset_variances();
}

void StampFilter::reset_variances() {
  hypotheses_.assign(kRatios.size(), {.weight = 1.0 / kRatios.size(), .scale_s2 = 0});
  variance_stamps_ = 0;
}

void StampFilter::initialize(std::span<const Timestamp> stamps) {
  stamps = stamps.first(std::min(stamps.size(), kWindow));
  if (stamps.size() < kMinStamps) return;
  estimate_variances(filters_of(stamps, PeriodCounts(stamps)), stamps.size());
}

void StampFilter::estimate_variances(const std::vector<TimeFilter>& filters, std::size_t stamps) {
  double best = filters[0].log_likelihood();
  for (const TimeFilter& filter : filters) best = std::max(best, filter.log_likelihood());
  double sum = 0;
  for (const TimeFilter& filter : filters) sum += std::exp(filter.log_likelihood() - best);
  for (std::size_t i = 0; i < filters.size(); ++i) {
    hypotheses_[i] = {.weight = std::exp(filters[i].log_likelihood() - best) / sum,
                      .scale_s2 = filters[i].scale_s2()};
  }
  variance_stamps_ = stamps;
}

FilteredStamp StampFilter::next(Timestamp stamp) {
  constexpr double kNegligibleRatio = 1e-3, kMinStepRatio = 0.1;
  const bool has_rate_changed = is_rate_change(stamp);
  if (has_rate_changed) reset_variances();
  if (has_rate_changed || is_interrupted_by(stamp)) return restart(stamp);
  if (window_.size() == kWindow) window_.erase(window_.begin());
  window_.push_back(stamp);
  const std::optional<Timestamp> before = std::exchange(last_, stamp);
  if (!before) return {.stamp = stamp};
  if (resolution_s_ == 0 && window_.size() >= kMinSmoothed && *before < stamp &&
      is_regular(window_)) {  // fast path
    jitter_s_ = interval_sigma_s_ = 0;
    period_s_ = seconds_between(window_[window_.size() - 2], stamp);
    return {.stamp = stamp};
  }
  const PeriodCounts counts(window_);
  const std::vector<TimeFilter> filters = filters_of(window_, counts);
  if (window_.size() >= std::max(variance_stamps_, kMinStamps))
    estimate_variances(filters, window_.size());
  set_jitter(filters);
  if (jitter_s_ * std::numbers::sqrt2 < kNegligibleRatio * period_s_) jitter_s_ = 0;
  if (jitter_s_ == 0 && *before < stamp) return {.stamp = stamp};

  double time_s = seconds_between(window_[0], stamp);
  if (variance_stamps_ >= kMinSmoothed) {
    time_s = 0;
    for (std::size_t i = 0; i < filters.size(); ++i) {
      time_s += hypotheses_[i].weight * filters[i].time_s();
    }
  }
  const double before_s = seconds_between(window_[0], *before);
  time_s = std::max(time_s, before_s + kMinStepRatio * period_s_);
  last_ = Timestamp{window_[0].ns + std::llround(1e9 * time_s)};
  double variance_s2 =
      step_variance(filters, time_s - before_s) + counts.last_variance() * square(period_s_);
  if (std::abs(residuals_s_[0]) > residual_limit_s_) {  // late, or at another rate
    const double interval_s = seconds_between(window_[window_.size() - 2], stamp);
    variance_s2 += square(residuals_s_[0]) + square(time_s - before_s - interval_s);
  }
  return {.stamp = *last_, .sigma_s = std::sqrt(variance_s2 / 2)};
}

// The stamp before was corrected and this one is not: the correction is an error of the interval.
FilteredStamp StampFilter::restart(Timestamp stamp) {
  const double correction_s = seconds_between(window_.back(), *last_);
  window_.assign(1, stamp);
  last_ = stamp;
  return {.stamp = stamp, .sigma_s = std::abs(correction_s) / std::numbers::sqrt2};
}

// Residuals of the intervals to whole periods. White jitter exceeds three sigma in three of four
// intervals with a probability of 1e-7. Six residuals of one sign have the probability 2 / 7! for
// jitter and 2 / 2^6 for independent intervals, times 0.3 % for their sum.
bool StampFilter::is_rate_change(Timestamp stamp) {
  constexpr double kSigmas = 3, kMinRatio = 0.01;
  if (window_.size() < kMinSmoothed) {
    residuals_s_.fill(0);
    residual_limit_s_ = 0;
    return false;
  }
  const double interval_s = seconds_between(window_.back(), stamp);
  const double periods = std::max(1.0, std::round(interval_s / period_s_));
  residual_limit_s_ = std::max(kSigmas * interval_sigma_s_, kMinRatio * period_s_);
  std::rotate(residuals_s_.begin(), residuals_s_.end() - 1, residuals_s_.end());
  residuals_s_[0] = interval_s - periods * period_s_;
  // a single late stamp: the two intervals together are two periods
  const double two_s = seconds_between(window_[window_.size() - 2], stamp);
  if (std::abs(two_s - 2 * period_s_) < residual_limit_s_) residuals_s_[0] = 0;
  const auto is_beyond = [this](double residual_s) {
    return std::abs(residual_s) > residual_limit_s_;
  };
  const auto has_sign_of_last = [this](double residual_s) {
    return residual_s * residuals_s_[0] > 0;
  };
  const double sum_s = std::accumulate(residuals_s_.begin(), residuals_s_.end(), 0.0);
  const double count = static_cast<double>(residuals_s_.size());
  return std::ranges::count_if(std::span(residuals_s_).first<4>(), is_beyond) >= 3 ||
         (is_beyond(sum_s / std::sqrt(count)) &&
          std::ranges::all_of(residuals_s_, has_sign_of_last));
}

// Step back, or a gap whose number of periods is unknown: the period after three stamps is known to
// 1 / 16 of itself if the jitter is below 3 % of it.
bool StampFilter::is_interrupted_by(Timestamp stamp) const {
  constexpr double kMaxPeriods = 8;
  if (window_.empty()) return false;
  const double interval_s = seconds_between(window_.back(), stamp);
  return interval_s <= 0 || (window_.size() >= kMinStamps && interval_s > kMaxPeriods * period_s_);
}

void StampFilter::set_jitter(const std::vector<TimeFilter>& filters) {
  double jitter_s2 = 0, interval_s2 = 0;
  period_s_ = 0;
  for (std::size_t i = 0; i < filters.size(); ++i) {
    const auto& [weight, scale_s2] = hypotheses_[i];
    const double own_s2 = std::max(kRatios[i].jitter * scale_s2, rounding_variance(resolution_s_));
    period_s_ += weight * filters[i].period_s();
    jitter_s2 += weight * own_s2;
    interval_s2 += weight * (kRatios[i].interval * scale_s2 + 2 * own_s2);
  }
  jitter_s_ = std::sqrt(jitter_s2);
  interval_sigma_s_ = std::sqrt(interval_s2);
}

// Variance of the error of a step, over all hypotheses.
double StampFilter::step_variance(const std::vector<TimeFilter>& filters, double step_s) const {
  const double rounding_s2 = rounding_variance(resolution_s_);
  double variance_s2 = 0;
  for (std::size_t i = 0; i < filters.size(); ++i) {
    const double jitter = kRatios[i].jitter;
    const double scale_s2 = hypotheses_[i].scale_s2;
    const double own_s2 =
        jitter > 0 ? filters[i].step_variance() * std::max(scale_s2, rounding_s2 / jitter)
                   : filters[i].step_variance() * scale_s2 + 2 * rounding_s2;
    variance_s2 += hypotheses_[i].weight * (own_s2 + square(step_s - filters[i].step_s()));
  }
  return variance_s2;
}

}  // namespace stillkite
