#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/fly_config.hpp"
#include "io/dataset/flight_inputs.hpp"
#include "live/mavlink/telemetry.hpp"
#include "live/operator/operator_command.hpp"
#include "live/sensors/sensor_lines.hpp"
#include "live/tether/command_gate.hpp"
#include "live/tether/station_lines.hpp"
#include "navigation/hover_pilot.hpp"
#include "navigation/pilot_step.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

/// Estimator of a live flight, in flight and from its record: the same telemetry and frames in the
/// same order give the same estimates.
class FlightEstimator {
 public:
  explicit FlightEstimator(FlyConfig config);

  /// Adds a packet of the autopilot.
  void receive(const mavlink::Packet& packet, Timestamp arrival);
  /// Adds the readings of a sensor line.
  void receive(const SensorLine& line, Timestamp arrival);
  /// Adds a message of the ground station.
  void receive(const StationMessage& message, Timestamp arrival);
  /// Applies a command of an operator. Returns why it is refused; hold_here takes effect with the
  /// next image, see PilotStep::is_setpoint_moved.
  [[nodiscard]] std::optional<std::string> receive(const OperatorCommand& command);

  /// False before the first frame while telemetry that defines the initial state is missing.
  [[nodiscard]] bool is_ready(Timestamp stamp) const;

  /// True once the readings of IMU and attitude reach the stamp. Those of a sensor that is absent,
  /// silent or slower than 20 Hz are not expected.
  [[nodiscard]] bool has_telemetry_until(Timestamp stamp) const;

  /// Estimate of a frame, gravity-aligned, and command to the ground station, decided at
  /// `decision`. The first frame sets the initial state. Throws InputError on an invalid
  /// calibration or initial state.
  [[nodiscard]] PilotStep step(const Frame& frame, Timestamp decision);

  /// Of the last frame, for drawing; empty before the first.
  [[nodiscard]] std::vector<WeightedFlow> flow_vectors() const;

  [[nodiscard]] bool has_tether() const { return config_.live.tether.port.has_value(); }
  [[nodiscard]] const CommandGate& gate() const { return gate_; }

  /// Valid after the first frame.
  [[nodiscard]] const FlightInputs& inputs() const { return *inputs_; }
  /// With the navigator's effective configuration after the first frame.
  [[nodiscard]] const FlyConfig& config() const { return config_; }

 private:
  void add(const SensorSample& sample);
  void initialize(const Frame& first);
  void discard_before(Timestamp oldest);
  void discard_old(Timestamp arrival);
  [[nodiscard]] bool uses_attitude() const;
  [[nodiscard]] std::optional<Eigen::Quaterniond> attitude_at(Timestamp stamp) const;

  FlyConfig config_;
  mavlink::Telemetry telemetry_;
  SensorLineReader sensor_lines_;
  CommandGate gate_;
  Eigen::Quaterniond body_from_autopilot_;
  SensorLog sensors_;                     // last seconds
  std::optional<Timestamp> oldest_kept_;  // telemetry of a flight without frames
  double height_offset_m_ = 0;
  std::optional<FlightInputs> inputs_;
  std::optional<HoverPilot> pilot_;
  bool hold_here_ = false;  // with the next image
  std::optional<Timestamp> last_frame_;
};

}  // namespace stillkite
