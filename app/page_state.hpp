#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/message_log.hpp"
#include "app/page_history.hpp"
#include "app/page_snapshot.hpp"

namespace stillkite {

/// What the page knows of a live flight.
struct PageState {
  std::int64_t flight = 0;                     ///< differs between two starts of the program
  std::shared_ptr<const PageSnapshot> newest;  ///< null before the first estimate
  FlightStatus status;
  std::vector<HistorySample> samples;  ///< the latest ones, ascending
  std::vector<OperatorMessage> messages;
};

/// Number of images per second and ratio of dropped ones over the last seconds of the samples.
struct ImageRates {
  std::optional<double> used_per_s;     ///< over 2 s
  std::optional<double> dropped_ratio;  ///< of the decoded ones, over 10 s
};
[[nodiscard]] ImageRates image_rates(const std::vector<HistorySample>& samples);

/// JSON of /state with the samples whose number is above `after`; unknown values are null.
[[nodiscard]] nlohmann::json page_json(const PageState& state, Timestamp now, std::int64_t after);

}  // namespace stillkite
