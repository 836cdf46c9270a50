#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "live/mavlink/packet.hpp"

namespace stillkite::mavlink {

struct ParserCounts {
  std::int64_t packets = 0;  ///< known message, valid checksum
  std::int64_t unknown = 0;  ///< packets of messages that are not read
  std::int64_t checksum_errors = 0;
  std::int64_t skipped_bytes = 0;  ///< outside packets
  std::int64_t lost = 0;           ///< gaps in the sequence numbers of the senders
};

/// Splits a byte stream into packets of MAVLink 1 and 2. After garbage it resumes at the next
/// packet with a valid checksum. Signatures are skipped, not verified.
class Parser {
 public:
  /// Adds bytes from the link.
  void add(std::span<const std::uint8_t> bytes);

  /// Next packet of a known message; nullopt if more bytes are needed.
  [[nodiscard]] std::optional<Packet> next();

  [[nodiscard]] const ParserCounts& counts() const { return counts_; }

 private:
  struct Header;
  [[nodiscard]] std::span<const std::uint8_t> rest() const;
  [[nodiscard]] bool has_valid_checksum(const Header& header, std::uint8_t crc_extra) const;
  void count_sequence(const Header& header);

  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;  // of the bytes that are not parsed
  bool in_sync_ = false;   // the bytes before are a packet
  std::map<std::pair<std::uint8_t, std::uint8_t>, std::uint8_t> sequences_;  // by system, component
  ParserCounts counts_;
};

}  // namespace stillkite::mavlink
