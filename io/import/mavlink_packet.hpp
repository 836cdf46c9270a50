#pragma once

#include <cstdint>
#include <optional>

#include "io/import/byte_source.hpp"

namespace stillkite {

/// MAVLink packet of version 1 or 2 with a valid checksum.
struct MavlinkPacket {
  std::uint32_t message = 0;  ///< number of the message type
  std::uint8_t system = 0;    ///< sender: vehicle or ground station
  std::uint8_t component = 0;
  Bytes payload;  ///< version 2 omits zeros at the end
};

/// Packet at the beginning of the bytes. Nullopt if there is none, if it is cut off, if its message
/// type is not one that the import reads, or if the checksum is wrong.
[[nodiscard]] std::optional<MavlinkPacket> parse_mavlink(Bytes bytes);

/// Length of the packet at the beginning of the bytes by its header; 0 without one.
[[nodiscard]] std::size_t mavlink_packet_bytes(Bytes bytes);

/// Largest packet: version 2 with 255 bytes of payload and a signature.
inline constexpr std::size_t kMaxMavlinkBytes = 280;

}  // namespace stillkite
