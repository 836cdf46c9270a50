#include "io/import/mavlink_packet.hpp"

namespace stillkite {
namespace {

constexpr std::uint8_t kMagic1 = 0xFE, kMagic2 = 0xFD;
constexpr std::size_t kHeader1 = 6, kHeader2 = 10, kChecksum = 2, kSignature = 13;

// Last byte of the checksum's input, by message type: it identifies the type's fields
// (CRC_EXTRA in the message definitions of MAVLink, common.xml and ardupilotmega.xml).
std::optional<std::uint8_t> checksum_seed(std::uint32_t message) {
  switch (message) {
    case 24:  // GPS_RAW_INT
      return 24;
    case 26:  // SCALED_IMU
      return 170;
    case 27:  // RAW_IMU
      return 144;
    case 29:  // SCALED_PRESSURE
      return 115;
    case 30:  // ATTITUDE
      return 39;
    case 31:  // ATTITUDE_QUATERNION
      return 246;
    case 33:  // GLOBAL_POSITION_INT
      return 104;
    case 105:  // HIGHRES_IMU
      return 93;
    case 132:  // DISTANCE_SENSOR
      return 85;
    case 173:  // RANGEFINDER
      return 83;
    default:
      return std::nullopt;
  }
}

// CRC-16/MCRF4XX.
std::uint16_t with_byte(std::uint16_t crc, std::uint8_t byte) {
  auto x = static_cast<std::uint8_t>(byte ^ (crc & 0xFF));
  x = static_cast<std::uint8_t>(x ^ (x << 4));
  return static_cast<std::uint16_t>((crc >> 8) ^ (x << 8) ^ (x << 3) ^ (x >> 4));
}

}  // namespace

std::size_t mavlink_packet_bytes(Bytes bytes) {
  if (bytes.size() < kHeader1) return 0;
  if (bytes[0] == kMagic1) return kHeader1 + bytes[1] + kChecksum;
  if (bytes[0] != kMagic2) return 0;
  return kHeader2 + bytes[1] + kChecksum + ((bytes[2] & 1) != 0 ? kSignature : 0);
}

std::optional<MavlinkPacket> parse_mavlink(Bytes bytes) {
  const std::size_t size = mavlink_packet_bytes(bytes);
  if (size == 0 || size > bytes.size()) return std::nullopt;
  const bool is_second = bytes[0] == kMagic2;
  const std::size_t header = is_second ? kHeader2 : kHeader1;
  MavlinkPacket packet{.system = bytes[is_second ? 5 : 3],
                       .component = bytes[is_second ? 6 : 4],
                       .payload = bytes.subspan(header, bytes[1])};
  packet.message = is_second ? bytes[7] | bytes[8] << 8 | bytes[9] << 16 : bytes[5];
  const std::optional<std::uint8_t> seed = checksum_seed(packet.message);
  if (!seed) return std::nullopt;
  std::uint16_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes.subspan(1, header - 1 + bytes[1]))
    crc = with_byte(crc, byte);
  if (with_byte(crc, *seed) != little_endian<std::uint16_t>(bytes, header + bytes[1])) {
    return std::nullopt;
  }
  return packet;
}

}  // namespace stillkite
