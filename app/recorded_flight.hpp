#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/flight_estimator.hpp"
#include "live/mavlink/parser.hpp"
#include "live/record/flight_replay.hpp"

namespace stillkite {

/// Result of a recorded image.
struct RecordedStep {
  Frame frame;
  Timestamp decision;    ///< time in flight
  CaptureCounts images;  ///< of the flight up to this image
  PilotStep result;
  float step_ms = 0;  ///< time of the estimator now
};

/// True for the folder of a flight that `stillkite fly` has recorded.
[[nodiscard]] bool is_flight_record(const std::filesystem::path& path);

/// Estimator of a recorded flight: the same frames and messages in the same order as in flight.
class RecordedFlight {
 public:
  /// Receives one line for each command of an operator, with the reason if it is refused.
  using Report = std::function<void(const std::string&)>;

  /// Throws InputError if the record is damaged or the configuration is invalid.
  RecordedFlight(
      const std::filesystem::path& folder, const std::vector<std::string>& overrides,
      Report report = [](const std::string&) {});

  /// Next used image; nullopt at the end of the record.
  [[nodiscard]] std::optional<RecordedStep> next();

  [[nodiscard]] std::int64_t frames() const { return replay_.frames(); }
  [[nodiscard]] const FlightEstimator& estimator() const { return estimator_; }

 private:
  void receive(const RecordedMessage& message);

  FlightEstimator estimator_;
  FlightReplay replay_;
  mavlink::Parser parser_;
  Report report_;
};

}  // namespace stillkite
