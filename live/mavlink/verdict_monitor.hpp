#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "live/mavlink/system_messages.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite::mavlink {

/// Counts discontinuities of the pose for `reset_counter`: a relocalization, a metric frame after
/// others that had lost the scale, and the first measured frame after more than `max_gap_s` without
/// a measurement.
class ResetCounter {
 public:
  explicit ResetCounter(double max_gap_s) : max_gap_s_(max_gap_s) {}

  std::uint8_t update(const NavigationEstimate& estimate);

 private:
  double max_gap_s_;
  std::optional<Timestamp> last_measured_;
  bool has_been_metric_ = false, has_lost_scale_ = false;
  std::uint8_t count_ = 0;
};

/// Texts for the operator: a warning once frames have not been measured or have been missing for a
/// second, and a notice once they have been measured for a second again.
class VerdictMonitor {
 public:
  [[nodiscard]] std::optional<Statustext> update(Timestamp stamp, Verdict verdict);
  /// While no frame arrives; `silence_s` since the last one.
  [[nodiscard]] std::optional<Statustext> without_image(double silence_s);

 private:
  std::optional<Timestamp> since_;  // of the present state, measured or not
  bool is_measured_ = true;
  bool has_warned_ = false;
};

}  // namespace stillkite::mavlink
