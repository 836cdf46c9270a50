#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/frame_period.hpp"
#include "geometry/time.hpp"

namespace stillkite {

class TimeFilter;

/// Stamp with its error.
struct FilteredStamp {
  Timestamp stamp;
  /// Standard deviation of the part of the error that changes from stamp to stamp: an interval's
  /// error has the variance 2 sigma_s^2. A constant part is a clock offset.
  double sigma_s = 0;
};

/// Estimates the true times behind jittering stamps (arrival, rounding), live.
///
/// Model: time t_k = t_(k-1) + m T + w_k with constant period T, m > 1 after missed frames; stamp
/// s_k = t_k + e_k; w and e are white. The ratio var(w) / var(e) is unknown: one Kalman filter of
/// (t, T) for each of several ratios, from a regular camera with jitter (0) to an irregular camera
/// with exact stamps (infinity), weighted by the likelihood of the last 128 stamps (static
/// multiple-model estimator, Bar-Shalom et al. 2001, section 11.6.2; the scale of the variances is
/// integrated out).
///
/// Stamps whose jitter changes an interval by less than 0.1 % are returned unchanged, with sigma 0:
/// the calibrated focal length, to which velocities are proportional too, has such an error.
///
/// Frames that arrive in a burst (buffered transmission, intervals below 0.4 periods) are late:
/// their stamps are predicted from the others. After an interruption, and before two stamps are on
/// time, stamps are returned unchanged, with the sigma of one period.
class StampFilter {
 public:
  /// `resolution_s`: step to which the stamps are rounded; 0: unknown.
  explicit StampFilter(double resolution_s = 0);

  /// Estimates the variances from the first stamps of a stream that is known in advance.
  void initialize(std::span<const Timestamp> stamps);

  /// Returned stamps ascend while the given ones do. Restarts after a step back, a gap of more than
  /// eight intervals or a change of the frame rate. The first 16 stamps without `initialize` are
  /// returned unchanged, with the sigma of their jitter so far. `following`: next stamps of a
  /// recorded stream, ascending; eight distinguish late frames from frames after missed ones.
  FilteredStamp next(Timestamp stamp, std::span<const Timestamp> following = {});

  /// Standard deviation of the jitter of the given stamps; 0 if they are returned unchanged.
  [[nodiscard]] double jitter_s() const { return jitter_s_; }
  [[nodiscard]] double resolution_s() const { return resolution_s_; }
  /// Mean interval of the last stamps without missed ones; 0 below two stamps.
  [[nodiscard]] double period_s() const { return period_s_; }
  /// Number of stamps in bursts: less than 0.4 periods after the one before.
  [[nodiscard]] int burst_stamps() const { return burst_stamps_; }

 private:
  struct Hypothesis {
    double weight = 0;
    double scale_s2 = 0;  // of the filter's variances
  };

  void estimate_variances(const std::vector<TimeFilter>& filters, std::size_t stamps);
  void reset_variances();
  FilteredStamp restart(std::span<const Timestamp> known, bool has_rate_changed);
  [[nodiscard]] bool is_rate_change(Timestamp stamp);
  [[nodiscard]] bool is_late_in_burst(Timestamp stamp) const;
  [[nodiscard]] bool is_interrupted_by(std::span<const Timestamp> known) const;
  void set_jitter(const std::vector<TimeFilter>& filters);
  [[nodiscard]] double step_variance(const std::vector<TimeFilter>& filters, double step_s) const;

  double resolution_s_;
  double jitter_s_ = 0, interval_sigma_s_ = 0, period_s_ = 0;
  std::array<double, 6> residuals_s_{};  // of the last intervals to whole periods, latest first
  double residual_limit_s_ = 0;
  FramePeriod frame_period_;
  double period_before_s_ = 0;     // of the stream before this window; 0: unknown
  std::int64_t flush_stamps_ = 0;  // number that may still be from before the last interruption
  int burst_stamps_ = 0;
  std::vector<Hypothesis> hypotheses_;  // of each ratio
  std::size_t variance_stamps_ = 0;     // number of stamps that the variances are from
  std::vector<Timestamp> window_;       // last stamps, as given
  std::optional<Timestamp> last_;       // as returned
};

}  // namespace stillkite
