#pragma once

#include <cstdint>
#include <optional>

#include "live/clock/clock_map.hpp"
#include "live/live_config.hpp"
#include "live/mavlink/packet.hpp"
#include "live/sensor_samples.hpp"

namespace stillkite::mavlink {

inline constexpr std::uint8_t kAutopilot = 1;  ///< MAV_COMP_ID_AUTOPILOT1

/// Reads the sensor messages of one autopilot, component 1 of its system. Gimbals, other vehicles
/// and ground stations on the link are ignored. Stamps are mapped to the local clock by the
/// smallest delay (ClockMap), less half of the shortest TIMESYNC round trip.
class Telemetry {
 public:
  Telemetry(const TelemetryConfig& config, std::uint8_t system_id)
      : config_(config), system_id_(system_id) {}

  /// Reading of a packet; nullopt if the configuration does not use its message, or if the reading
  /// is invalid or not newer than the last of its kind.
  [[nodiscard]] std::optional<SensorSample> read(const Packet& packet, Timestamp arrival);

 private:
  [[nodiscard]] std::optional<SensorSample> read_imu(const Packet& packet, Timestamp arrival);
  [[nodiscard]] std::optional<SensorSample> read_attitude(const Packet& packet, Timestamp arrival);
  [[nodiscard]] std::optional<SensorSample> read_height(const Packet& packet, Timestamp arrival);
  void update_round_trip(const Packet& packet, Timestamp arrival);
  [[nodiscard]] Timestamp stamp_of(ClockMap& clock, std::int64_t sender_ns,
                                   Timestamp arrival) const;

  TelemetryConfig config_;
  std::uint8_t system_id_;
  ClockMap boot_clock_, usec_clock_;  // of time_boot_ms and time_usec
  std::int64_t round_trip_ns_ = 0;    // shortest; 0: unknown
  std::optional<Timestamp> last_imu_, last_attitude_, last_height_;
};

}  // namespace stillkite::mavlink
