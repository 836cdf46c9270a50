#pragma once

#include <functional>
#include <optional>
#include <string>

#include "app/autopilot_output.hpp"
#include "app/json_output.hpp"
#include "io/dataset/flight_inputs.hpp"
#include "live/link/autopilot_link.hpp"
#include "live/live_config.hpp"

namespace stillkite {

/// Readers of a live flight's estimates: JSON lines and autopilot.
class FlightOutput {
 public:
  using Report = std::function<void(const std::string&)>;

  /// `autopilot` outlives the output; null without a link. `max_gap_s`: as for AutopilotOutput.
  /// Throws InputError as JsonOutput.
  FlightOutput(const LiveConfig& live, AutopilotLink* autopilot, double max_gap_s, Report report);

  /// Throws std::runtime_error if standard output is closed and there is no autopilot.
  void send(const NavigationEstimate& estimate, const FlightInputs& inputs);

  /// Text for the autopilot's operator if images have been missing for a second.
  void report_missing_images(double silence_s);

  void report_counts();

 private:
  void send_json(const NavigationEstimate& estimate);

  Report report_;
  std::optional<JsonOutput> json_;
  std::optional<AutopilotOutput> autopilot_;
};

}  // namespace stillkite
