#include "geometry/stamp_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "geometry/period_counts.hpp"
#include "geometry/time_filter.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kWindow = 128;
constexpr std::size_t kMinStamps = 3;  // two determine time and period
// White jitter correlates neighbouring intervals by -1/2, irregular intervals by 0. The difference
// is two standard errors of 16 intervals.
constexpr std::size_t kMinSmoothed = 17;
constexpr std::size_t kFollowing = 8;  // frames of a burst, at most

// The time constant of a filter is 1 / sqrt(ratio) frames, from the window's length to below one.
constexpr auto kRatios = std::to_array<VarianceRatio>(
    {{0, 1}, {1e-4, 1}, {1e-3, 1}, {1e-2, 1}, {0.1, 1}, {1, 1}, {10, 1}, {1, 0}});

double square(double x) {
  return x * x;
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

// Filters at the last of the stamps, by those that are not late; empty below two of them.
std::vector<TimeFilter> filters_of(std::span<const Timestamp> stamps, const PeriodCounts& counts) {
  std::vector<TimeFilter> filters;
  std::optional<double> first_s;
  double periods = 0;  // since the first
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const double stamp_s = seconds_between(stamps[0], stamps[i]);
    periods += first_s ? counts[i] : 0;
    for (TimeFilter& filter : filters) {
      counts.is_late(i) ? filter.predict(counts[i]) : filter.update(stamp_s, counts[i]);
    }
    if (counts.is_late(i) || !filters.empty()) continue;
    for (const VarianceRatio& ratio : kRatios) {
      if (first_s) filters.emplace_back(ratio, *first_s, stamp_s, periods);
    }
    if (!first_s) first_s = stamp_s;
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
  frame_period_.clear();
  for (std::size_t i = 1; i < stamps.size(); ++i) frame_period_.add(stamps[i - 1], stamps[i]);
  if (stamps.size() < kMinStamps) return;
  const PeriodCounts counts(stamps, frame_period_.with({}), false);
  const std::vector<TimeFilter> filters = filters_of(stamps, counts);
  if (!filters.empty()) estimate_variances(filters, counts.on_time(stamps.size()));
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

FilteredStamp StampFilter::next(Timestamp stamp, std::span<const Timestamp> following) {
  constexpr double kNegligibleRatio = 1e-3, kMinStepRatio = 0.1;
  std::vector<Timestamp> known{stamp};
  following = following.first(std::min(following.size(), kFollowing));
  known.insert(known.end(), following.begin(), following.end());
  const double raw_s = window_.empty() ? 0 : seconds_between(window_.back(), stamp);
  const bool is_flush = flush_stamps_ > 0 && raw_s < kMaxBurstRatio * period_before_s_;
  flush_stamps_ -= is_flush ? 1 : 0;
  const bool has_rate_changed = !is_flush && is_rate_change(stamp);
  if (has_rate_changed) reset_variances();
  if (has_rate_changed || is_interrupted_by(known)) return restart(known, has_rate_changed);
  if (window_.size() == kWindow) window_.erase(window_.begin());
  window_.push_back(stamp);
  const std::optional<Timestamp> before = std::exchange(last_, stamp);
  if (!before) return {.stamp = stamp};
  frame_period_.add(window_[window_.size() - 2], stamp);
  if (resolution_s_ == 0 && !is_flush && window_.size() >= kMinSmoothed && *before < stamp &&
      is_regular(window_)) {  // fast path
    jitter_s_ = interval_sigma_s_ = 0;
    period_s_ = raw_s;
    return {.stamp = stamp};
  }
  const double frame_s = frame_period_.with(known);
  const std::size_t at = window_.size() - 1;
  burst_stamps_ += raw_s < kMaxBurstRatio * frame_s ? 1 : 0;
  known.insert(known.begin(), window_.begin(), window_.end() - 1);
  const PeriodCounts counts(known, frame_s, is_flush);
  const std::vector<TimeFilter> filters = filters_of(window_, counts);
  const bool is_burst = counts.is_late(at) || counts.is_late(at - 1);
  if (filters.empty()) {  // the period is known, not which stamp is on time
    return {.stamp = stamp, .sigma_s = std::abs(raw_s - frame_s) / std::numbers::sqrt2};
  }
  const std::size_t on_time = counts.on_time(window_.size());
  if (on_time >= std::max(variance_stamps_, kMinStamps)) estimate_variances(filters, on_time);
  set_jitter(filters);
  if (jitter_s_ * std::numbers::sqrt2 < kNegligibleRatio * period_s_) jitter_s_ = 0;
  if (jitter_s_ == 0 && !is_burst && *before < stamp) return {.stamp = stamp};

  double time_s = seconds_between(window_[0], stamp);
  if (variance_stamps_ >= kMinSmoothed || counts.is_late(at)) {
    time_s = 0;
    for (std::size_t i = 0; i < filters.size(); ++i) {
      time_s += hypotheses_[i].weight * filters[i].time_s();
    }
  }
  const double before_s = seconds_between(window_[0], *before);
  time_s = std::max(time_s, before_s + kMinStepRatio * period_s_);
  last_ = Timestamp{window_[0].ns + std::llround(1e9 * time_s)};
  double variance_s2 = step_variance(filters, time_s - before_s) +
                       (following.empty() ? counts.last_variance() * square(period_s_) : 0);
  if (!is_burst && std::abs(residuals_s_[0]) > residual_limit_s_) {  // late, or at another rate
    variance_s2 += square(residuals_s_[0]) + square(time_s - before_s - raw_s);
  }
  return {.stamp = *last_, .sigma_s = std::sqrt(variance_s2 / 2)};
}

// The stamp before was corrected and this one is not: the correction is an error of the interval.
// After a gap the frames that are due since may follow at once: then the first one is late.
FilteredStamp StampFilter::restart(std::span<const Timestamp> known, bool has_rate_changed) {
  const double gap_s = seconds_between(window_.back(), known[0]);
  double error_s2 = square(seconds_between(window_.back(), *last_));
  period_before_s_ = std::max(period_s_, frame_period_.with({}));
  flush_stamps_ = 0;
  if (has_rate_changed || gap_s <= 0 || period_before_s_ == 0) {
    frame_period_.clear();
  } else {
    frame_period_.add(window_.back(), known[0]);
    flush_stamps_ = std::llround(gap_s / period_before_s_);
    const bool is_late =
        known.size() > 1 && seconds_between(known[0], known[1]) < kMaxBurstRatio * period_before_s_;
    if (is_late) error_s2 += square(gap_s - period_before_s_);
  }
  window_.assign(1, known[0]);
  last_ = known[0];
  return {.stamp = known[0], .sigma_s = std::sqrt(error_s2 / 2)};
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
  if (std::abs(two_s - 2 * period_s_) < residual_limit_s_ || is_late_in_burst(stamp)) {
    residuals_s_[0] = 0;
  }
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

// True for a short interval in a burst of up to eight frames, all late by the stamps before it.
bool StampFilter::is_late_in_burst(Timestamp stamp) const {
  if (seconds_between(window_.back(), stamp) > kMaxBurstRatio * period_s_) return false;
  for (std::size_t k = 2; k <= std::min(kFollowing, window_.size()); ++k) {
    const double due_s = static_cast<double>(k) * period_s_;
    if (seconds_between(window_[window_.size() - k], stamp) - due_s > -residual_limit_s_)
      return true;
  }
  return false;
}

// Step back, or a gap whose number of periods is unknown: the period after three stamps is known to
// 1 / 16 of itself if the jitter is below 3 % of it. Not a gap that the next stamps make up for.
bool StampFilter::is_interrupted_by(std::span<const Timestamp> known) const {
  constexpr double kMaxPeriods = 8, kMaxLatePeriods = 1.5;
  if (window_.empty()) return false;
  if (known[0] <= window_.back()) return true;
  if (window_.size() < kMinStamps) return false;
  const double period_s = std::max(period_s_, frame_period_.with(known));
  if (seconds_between(window_.back(), known[0]) <= kMaxPeriods * period_s) return false;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const double due_s = (static_cast<double>(i) + kMaxLatePeriods) * period_s;
    if (seconds_between(window_.back(), known[i]) < due_s) return false;
  }
  return true;
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
