#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "app/page_snapshot.hpp"
#include "estimation/verdict.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Interval of 0.25 s for the charts of the page. NaN: unknown.
struct HistorySample {
  std::int64_t number = 0;  ///< ascends
  Timestamp time;           ///< of the last image
  double speed = std::numeric_limits<double>::quiet_NaN();
  double height = std::numeric_limits<double>::quiet_NaN();
  double displacement_m = std::numeric_limits<double>::quiet_NaN();
  double latency_ms = 0;  ///< maximum
  /// Of the last image whose motion is not measured, else of the last image.
  Verdict verdict = Verdict::ok;
  /// Since the beginning of the flight.
  std::int64_t used_images = 0, decoded_images = 0, replaced_images = 0;
};

/// Sample of one image. Speed and height are metric, or in initial heights (is_in_heights).
[[nodiscard]] HistorySample history_sample(const PageSnapshot& snapshot,
                                           const FlightStatus& status);

/// Joins samples of images into intervals.
class PageHistory {
 public:
  void add(const HistorySample& sample);
  /// Intervals that ended since the last call.
  [[nodiscard]] std::vector<HistorySample> take();

 private:
  std::optional<HistorySample> current_;
  Timestamp begin_;  // of the current interval
  std::vector<HistorySample> ended_;
};

}  // namespace stillkite
