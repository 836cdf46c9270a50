#include "live/mavlink/packet.hpp"

#include "live/mavlink/sensor_messages.hpp"
#include "live/mavlink/system_messages.hpp"
#include "live/mavlink/vision_messages.hpp"

namespace stillkite::mavlink {
namespace {

struct KnownMessage {
  std::uint32_t id = 0;
  std::uint8_t crc_extra = 0;
};

template <Message... M>
constexpr auto known_messages() {
  return std::to_array<KnownMessage>({{M::kId, kLayout<M>.crc_extra}...});
}

constexpr auto kMessages =
    known_messages<Heartbeat, Timesync, Statustext, SetGpsGlobalOrigin, AttitudeQuaternion,
                   HighresImu, ScaledImu, ScaledImu2, ScaledImu3, RawImu, DistanceSensor,
                   GlobalPositionInt, Odometry, OpticalFlow, OpticalFlowRad, VisionPositionEstimate,
                   VisionSpeedEstimate>();

}  // namespace

std::optional<std::uint8_t> crc_extra(std::uint32_t id) {
  for (const KnownMessage& message : kMessages) {
    if (message.id == id) return message.crc_extra;
  }
  return std::nullopt;
}

PacketBytes pack(std::uint32_t id, std::span<const std::uint8_t> payload, std::uint8_t crc_extra,
                 Sender& sender) {
  while (payload.size() > 1 && payload.back() == 0) payload = payload.first(payload.size() - 1);
  constexpr std::uint8_t kMagic = 0xfd;
  PacketBytes out;
  Checksum checksum;
  out.push(kMagic);
  const auto push = [&](std::uint8_t byte) {
    out.push(byte);
    checksum.add(byte);
  };
  push(static_cast<std::uint8_t>(payload.size()));
  push(0);  // incompatibility flags
  push(0);  // compatibility flags
  push(sender.sequence++);
  push(sender.system);
  push(sender.component);
  for (const unsigned shift : {0U, 8U, 16U}) push(static_cast<std::uint8_t>(id >> shift));
  for (const std::uint8_t byte : payload) push(byte);
  checksum.add(crc_extra);
  out.push(static_cast<std::uint8_t>(checksum.value()));
  out.push(static_cast<std::uint8_t>(checksum.value() >> 8));
  return out;
}

}  // namespace stillkite::mavlink
