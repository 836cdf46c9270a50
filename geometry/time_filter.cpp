#include "geometry/time_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillkite {
namespace {

double squared(double x) {
  return x * x;
}

}  // namespace

TimeFilter::TimeFilter(const VarianceRatio& ratio, double first_s, double second_s, double periods)
    : q_(ratio.interval),
      r_(ratio.jitter),
      time_s_(second_s),
      period_s_((second_s - first_s) / periods),
      time_variance_(r_),
      covariance_(r_ / periods),
      period_variance_((2 * r_ + periods * q_) / squared(periods)),
      step_s_(second_s - first_s),
      step_variance_(2 * r_) {}

void TimeFilter::predict(double periods) {
  const double m = periods;
  step_s_ = m * period_s_;
  step_variance_ = squared(m) * period_variance_ + m * q_;
  time_s_ += step_s_;
  time_variance_ += 2 * m * covariance_ + step_variance_;
  covariance_ += m * period_variance_;
}

void TimeFilter::update(double stamp_s, double periods) {
  const double m = periods;
  const double q = m * q_;
  const double predicted_variance =
      time_variance_ + 2 * m * covariance_ + squared(m) * period_variance_ + q;
  const double predicted_covariance = covariance_ + m * period_variance_;
  const double innovation_variance = predicted_variance + r_;
  const double innovation_s = stamp_s - (time_s_ + m * period_s_);
  squares_ += squared(innovation_s) / innovation_variance;
  log_determinant_ += std::log(innovation_variance);
  ++count_;
  const double gain = predicted_variance / innovation_variance;
  // error of the step between two estimated times: (1 - K)(m e_T + w) - K e_t + K e
  step_variance_ = squared(gain) * (time_variance_ + r_) - 2 * gain * (1 - gain) * m * covariance_ +
                   squared(1 - gain) * (squared(m) * period_variance_ + q);
  step_s_ = m * period_s_ + gain * innovation_s;
  time_s_ += step_s_;
  const double period_gain = predicted_covariance / innovation_variance;
  period_s_ += period_gain * innovation_s;
  time_variance_ = (1 - gain) * predicted_variance;
  covariance_ = (1 - gain) * predicted_covariance;
  period_variance_ -= period_gain * predicted_covariance;
}

double TimeFilter::log_likelihood() const {
  const double floor = std::numeric_limits<double>::min();  // exact stamps
  return -0.5 * (count_ * std::log(std::max(squares_, floor)) + log_determinant_);
}

}  // namespace stillkite
