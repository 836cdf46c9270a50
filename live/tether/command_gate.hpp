#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "geometry/time.hpp"
#include "live/operator/operator_command.hpp"
#include "live/tether/station_lines.hpp"
#include "live/tether_config.hpp"
#include "stabilization/hold_decision.hpp"

namespace stillkite {

/// Permission of operator and ground station to send the controller's commands, and the latest
/// tether reading. The same messages in the same order give the same results.
///
/// Stick, landing, return and faults of the ground station end an engagement: the operator has to
/// engage again. Silence and images that are not measured withhold the commands while they last.
class CommandGate {
 public:
  /// `max_reading_age_s`: of !Pos, of !GSStatus as a length, and of !Attitude.
  CommandGate(const TetherConfig& config, double max_reading_age_s)
      : config_(config), max_reading_age_s_(max_reading_age_s) {}

  void receive(const StationMessage& message, Timestamp arrival);
  /// Result of the latest image. `displacement_m`: from the pose to hold, if it is metric.
  void set_estimate(Timestamp now, bool is_measured, std::optional<double> displacement_m);

  /// Applies engage, release or stop; others have no effect here. Returns why an engagement is
  /// refused, with the remedy: a reason of the ground station, no recently measured image, or a
  /// metric displacement above `max_displacement_m`.
  [[nodiscard]] std::optional<std::string> apply(const OperatorCommand& command,
                                                 double max_displacement_m);

  /// Reason to withhold the command at `now`; ends the engagement where the class says so.
  [[nodiscard]] HoldReason withheld(Timestamp now);

  [[nodiscard]] bool is_engaged() const { return is_engaged_; }
  [[nodiscard]] bool is_stopped() const { return is_stopped_; }
  /// Stamp: arrival of the older part, less the configured latency.
  [[nodiscard]] std::optional<TetherReading> tether() const;

 private:
  template <typename Message>
  struct Received {
    Message message;
    Timestamp arrival;
  };
  [[nodiscard]] HoldReason station_reason(Timestamp now) const;
  [[nodiscard]] bool is_unmeasured(Timestamp now) const;
  [[nodiscard]] std::optional<std::string> refusal(Timestamp now, double max_displacement_m) const;

  TetherConfig config_;
  double max_reading_age_s_;
  std::optional<Received<StationStatus>> station_;
  std::optional<Received<DronePosition>> position_;
  std::optional<Received<DroneStatus>> drone_;
  std::optional<Timestamp> attitude_arrival_;
  std::optional<Timestamp> last_measured_;
  std::optional<double> displacement_m_;
  bool is_engaged_ = false, is_stopped_ = false;
};

}  // namespace stillkite
