#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "app/flight_estimator.hpp"
#include "live/link/autopilot_link.hpp"
#include "live/live_config.hpp"
#include "live/record/flight_record.hpp"
#include "live/sensors/sensor_link.hpp"

namespace stillkite {

/// Reports once that a link is silent, and once that it is connected again.
class SilenceMonitor {
 public:
  SilenceMonitor(std::string link, std::string message)
      : link_(std::move(link)), message_(std::move(message)) {}

  void hear(Timestamp arrival) { last_ = arrival; }
  /// Line to report; nullopt without a change.
  [[nodiscard]] std::optional<std::string> change(Timestamp now);

 private:
  std::string link_, message_;
  std::optional<Timestamp> last_;  // first call of `change`, then arrivals
  bool is_silent_ = false;
};

/// Telemetry of a live flight: passes packets of the autopilot and sensor lines to record and
/// estimator.
class FlightTelemetry {
 public:
  using Report = std::function<void(const std::string&)>;

  /// Throws InputError as AutopilotLink and SensorLink.
  FlightTelemetry(const LiveConfig& live, Report report);

  /// Passes what has arrived; returns the number of recorded messages.
  [[nodiscard]] std::int64_t receive(FlightEstimator& estimator, FlightRecord& record);

  /// Reports links that are silent, and rejected sensor lines.
  void report_changes();
  /// Reports the numbers of messages.
  void report_counts();

  /// Null without a link.
  [[nodiscard]] AutopilotLink* autopilot() { return autopilot_ ? &*autopilot_ : nullptr; }

 private:
  void check_system(const mavlink::Packet& packet);

  Report report_;
  int system_id_;
  std::optional<AutopilotLink> autopilot_;
  std::optional<SensorLink> sensors_;
  SilenceMonitor autopilot_silence_{"MAVLink", "packet"}, sensor_silence_{"sensors", "line"};
  bool has_reported_system_ = false, has_reported_line_ = false;
};

}  // namespace stillkite
