#pragma once

namespace stillkite {

/// Variances of the changes of a stream's true intervals and of the errors of its stamps, in units
/// of an unknown scale.
struct VarianceRatio {
  double interval = 0;
  double jitter = 1;
};

/// Kalman filter of time t and period T, relative to the first stamp: t_k = t_(k-1) + m T + w_k,
/// stamp s_k = t_k + e_k, with white w and e. Variances are in units of `scale_s2`.
class TimeFilter {
 public:
  /// The first two stamps, `periods` periods apart, determine time and period.
  TimeFilter(const VarianceRatio& ratio, double first_s, double second_s, double periods);

  /// Time of a frame without a stamp.
  void predict(double periods);

  /// `periods`: m, the number of periods since the stamp before.
  void update(double stamp_s, double periods);

  [[nodiscard]] double time_s() const { return time_s_; }
  [[nodiscard]] double period_s() const { return period_s_; }
  /// Last step from one estimated time to the next, and the variance of its error.
  [[nodiscard]] double step_s() const { return step_s_; }
  [[nodiscard]] double step_variance() const { return step_variance_; }
  /// Scale by maximum likelihood; 0 below three stamps.
  [[nodiscard]] double scale_s2() const { return count_ > 0 ? squares_ / count_ : 0; }
  /// Log-likelihood of the ratio, with the scale integrated out by the prior 1 / scale.
  [[nodiscard]] double log_likelihood() const;

 private:
  double q_, r_;
  double time_s_, period_s_;
  double time_variance_, covariance_, period_variance_;
  double step_s_, step_variance_;
  double squares_ = 0, log_determinant_ = 0;
  int count_ = 0;
};

}  // namespace stillkite
