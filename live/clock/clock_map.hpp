#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "geometry/stamp_filter.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Maps the stamps of a sender to the local monotonic clock.
///
/// Model: arrival a_k = s_k + c + r s_k + d + e_k; stamp s_k, clock offset c, skew r, smallest
/// delay d and a queueing delay e_k >= 0 that is close to zero now and then. Estimator: the line
/// below all points (s, a - s) of the last minute that minimizes the sum of the e_k (linear program
/// of Moon, Skelly and Towsley, INFOCOM 1999): the edge of the lower convex hull under the mean of
/// the s_k. The mapped stamp s + line(s) is later than the true one by d, which delays alone cannot
/// show: set it as a constant latency.
///
/// Restarts if the sender's clock steps: a stamp one second before the previous one, one second too
/// early for its arrival, or late for five seconds.
class ClockMap {
 public:
  /// `sender_ns`: the sender's stamp, ns since any epoch. `arrival`: local monotonic clock, in the
  /// order of arrival. `sigma_s` of the result: error that changes from stamp to stamp; infinite
  /// for the first stamp, whose delay is unknown.
  [[nodiscard]] FilteredStamp map(std::int64_t sender_ns, Timestamp arrival);

  /// Rate of the local clock relative to the sender's, minus 1.
  [[nodiscard]] double skew() const { return slope_; }
  /// Mean delay above the smallest one.
  [[nodiscard]] double mean_delay_s() const;
  [[nodiscard]] std::int64_t restarts() const { return restarts_; }

 private:
  // Points of an interval: their number, sums, and the one of the smallest delay.
  struct Bucket {
    std::int64_t index = 0, count = 0;
    double sum_x_s = 0, sum_y_s = 0;
    double x_s = 0, y_s = 0;
  };
  struct Sums {
    double count = 0, x_s = 0, y_s = 0;
  };

  [[nodiscard]] bool has_stepped(double x_s, double y_s);
  void restart(std::int64_t sender_ns, Timestamp arrival);
  void add(double x_s, double y_s);
  void fit();
  [[nodiscard]] Sums sums() const;
  [[nodiscard]] double line_s(double x_s) const { return offset_s_ + slope_ * x_s; }

  std::int64_t first_sender_ns_ = 0;
  Timestamp first_arrival_;
  std::deque<Bucket> buckets_;
  double last_x_s_ = 0;
  std::optional<double> late_since_s_;  // sender time
  double offset_s_ = 0, slope_ = 0;     // line y = offset + slope x
  std::int64_t restarts_ = -1;
};

}  // namespace stillkite
