#pragma once

#include <array>
#include <cstring>
#include <optional>
#include <span>

#include "live/mavlink/layout.hpp"

namespace stillkite::mavlink {

/// Bytes of one packet.
class PacketBytes {
 public:
  /// Header, payload, checksum and signature of MAVLink 2.
  static constexpr std::size_t kMaxBytes = 10 + kMaxPayload_bytes + 2 + 13;

  void push(std::uint8_t byte) { bytes_[size_++] = byte; }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const {
    return std::span(bytes_).first(size_);
  }

 private:
  std::array<std::uint8_t, kMaxBytes> bytes_{};
  std::size_t size_ = 0;
};

/// Packet of a known message with a valid checksum.
struct Packet {
  std::uint32_t id = 0;
  std::uint8_t system = 0, component = 0, sequence = 0;
  bool is_signed = false;
  std::array<std::uint8_t, kMaxPayload_bytes> payload{};  ///< truncated zeros restored
  PacketBytes raw;                                        ///< as received
};

/// Sending component; numbers its packets.
struct Sender {
  std::uint8_t system = 1;
  std::uint8_t component = 197;  ///< MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY
  std::uint8_t sequence = 0;
};

/// Visitor for `fields` of a message that copies each value to its place in the payload.
class PayloadWriter {
 public:
  PayloadWriter(const Layout& layout, std::span<std::uint8_t> payload)
      : layout_(layout), payload_(payload) {}
  template <typename T>
  void operator()(std::string_view /*name*/, const T& value) {
    const FieldLayout& field = layout_.fields[index_++];
    std::memcpy(payload_.data() + field.offset, &value, field.bytes());
  }
  void extensions() {}

 private:
  const Layout& layout_;
  std::span<std::uint8_t> payload_;
  std::size_t index_ = 0;
};

/// Visitor for `fields` of a message that reads each value from its place in the payload.
class PayloadReader {
 public:
  PayloadReader(const Layout& layout, std::span<const std::uint8_t> payload)
      : layout_(layout), payload_(payload) {}
  template <typename T>
  void operator()(std::string_view /*name*/, T& value) {
    const FieldLayout& field = layout_.fields[index_++];
    std::memcpy(&value, payload_.data() + field.offset, field.bytes());
  }
  void extensions() {}

 private:
  const Layout& layout_;
  std::span<const std::uint8_t> payload_;
  std::size_t index_ = 0;
};

/// MAVLink 2 packet of a payload, without its trailing zeros and without a signature.
[[nodiscard]] PacketBytes pack(std::uint32_t id, std::span<const std::uint8_t> payload,
                               std::uint8_t crc_extra, Sender& sender);

template <Message M>
[[nodiscard]] PacketBytes encode(const M& message, Sender& sender) {
  constexpr const Layout& kWire = kLayout<M>;
  static_assert(kWire.length <= kMaxPayload_bytes);
  std::array<std::uint8_t, kWire.length> payload{};
  M::fields(message, PayloadWriter(kWire, payload));
  return pack(M::kId, payload, kWire.crc_extra, sender);
}

/// Message of a packet; nullopt if it is another message.
template <Message M>
[[nodiscard]] std::optional<M> decode(const Packet& packet) {
  if (packet.id != M::kId) return std::nullopt;
  M message;
  M::fields(message, PayloadReader(kLayout<M>, packet.payload));
  return message;
}

/// CRC_EXTRA of a message that this program reads or writes; nullopt for any other id.
[[nodiscard]] std::optional<std::uint8_t> crc_extra(std::uint32_t id);

}  // namespace stillkite::mavlink
