#pragma once

#include <array>
#include <mutex>
#include <optional>
#include <vector>

#include "live/link/port.hpp"
#include "live/mavlink/packet.hpp"
#include "live/mavlink/parser.hpp"

namespace stillkite {

/// Packet with its arrival on the local clock.
struct ReceivedPacket {
  mavlink::Packet packet;
  Timestamp arrival;
};

/// MAVLink connection to an autopilot. Its thread receives, answers TIMESYNC requests, and sends
/// HEARTBEAT, a TIMESYNC request and, ten times after the autopilot is heard,
/// SET_GPS_GLOBAL_ORIGIN, once per second.
class AutopilotLink {
 public:
  /// `origin`: latitude, longitude [deg], altitude [m]. Throws InputError as Port.
  AutopilotLink(const LinkAddress& address, std::uint8_t system_id,
                const std::optional<std::array<double, 3>>& origin);

  /// Packets since the last call, in the order of arrival.
  [[nodiscard]] std::vector<ReceivedPacket> take();

  template <mavlink::Message M>
  void send(const M& message) {
    const std::lock_guard lock(mutex_);
    port_.send(mavlink::encode(message, sender_).bytes());
  }

  [[nodiscard]] mavlink::ParserCounts counts();

 private:
  void receive(std::span<const std::uint8_t> bytes, Timestamp arrival);
  void answer(const mavlink::Packet& packet, Timestamp arrival);
  void tick();

  std::optional<std::array<double, 3>> origin_;
  int origins_to_send_ = 0;
  bool has_heard_autopilot_ = false;
  std::mutex mutex_;  // of parser_, inbox_ and sender_
  mavlink::Parser parser_;
  std::vector<ReceivedPacket> inbox_;
  mavlink::Sender sender_;
  Port port_;  // last: its thread uses all other members
};

}  // namespace stillkite
