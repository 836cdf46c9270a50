#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "app/flight_estimator.hpp"
#include "live/live_config.hpp"
#include "live/operator/operator_command.hpp"
#include "live/operator/operator_input.hpp"
#include "live/record/flight_record.hpp"
#include "live/tether/tether_link.hpp"

namespace stillkite {

/// Ground station and operator of a live flight: passes their messages to record and estimator,
/// and the estimator's commands to the supervising process.
class TetherControl {
 public:
  using Report = std::function<void(const std::string&)>;

  /// Forks the supervising process: no other thread may run yet. Throws InputError as TetherLink
  /// and OperatorInput.
  TetherControl(const LiveConfig& live, Report report);

  /// Begins commands.csv of the record.
  void log_to(const std::filesystem::path& folder, FlightRecord& record);

  /// Passes what has arrived to estimator and record; returns the number of recorded messages. If
  /// an engagement has ended, the rates are set to zero at once.
  [[nodiscard]] std::int64_t receive(FlightEstimator& estimator, FlightRecord& record);

  /// Sends the command of an image and records it.
  void send(const PilotStep& step, const FlightEstimator& estimator, FlightRecord& record);

  [[nodiscard]] bool is_supervised() const { return link_.is_supervised(); }

  /// Queue of further front ends.
  [[nodiscard]] OperatorQueue& operators() { return operators_; }

  /// One line with the numbers of messages.
  [[nodiscard]] std::string counts() const;

 private:
  void receive_operators(FlightEstimator& estimator, FlightRecord& record);
  void receive_station(FlightEstimator& estimator, FlightRecord& record);

  Report report_;
  TetherLink link_;
  OperatorQueue operators_;
  std::optional<OperatorInput> input_;
  std::int64_t recorded_ = 0;  // in the current call of `receive`
  std::int64_t lines_ = 0, ignored_lines_ = 0, commands_ = 0, holds_ = 0;
  TetherOrder last_;
  HoldReason last_withheld_ = HoldReason::not_engaged;
  bool awaits_setpoint_ = false;
  bool has_reported_end_ = false, has_reported_input_ = false;
};

}  // namespace stillkite
