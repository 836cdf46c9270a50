#include "live/mavlink/parser.hpp"

#include <algorithm>

namespace stillkite::mavlink {
namespace {

constexpr std::uint8_t kMagic1 = 0xfe, kMagic2 = 0xfd;
constexpr std::size_t kHeader1_bytes = 6, kHeader2_bytes = 10;
constexpr std::size_t kChecksum_bytes = 2, kSignature_bytes = 13;
constexpr std::uint8_t kSigned = 1;  // incompatibility flag

}  // namespace

struct Parser::Header {
  std::size_t header_bytes = 0, payload_bytes = 0, packet_bytes = 0;
  std::uint32_t id = 0;
  std::uint8_t system = 0, component = 0, sequence = 0;
  bool is_signed = false;

  // Header at the beginning of `bytes`, which has a magic number and at least a header's length;
  // nullopt with unknown incompatibility flags.
  static std::optional<Header> read(std::span<const std::uint8_t> bytes) {
    Header out{.payload_bytes = bytes[1]};
    if (bytes[0] == kMagic1) {
      out.header_bytes = kHeader1_bytes;
      out.sequence = bytes[2];
      out.system = bytes[3];
      out.component = bytes[4];
      out.id = bytes[5];
    } else {
      if ((bytes[2] & ~kSigned) != 0) return std::nullopt;
      out.header_bytes = kHeader2_bytes;
      out.is_signed = (bytes[2] & kSigned) != 0;
      out.sequence = bytes[4];
      out.system = bytes[5];
      out.component = bytes[6];
      out.id = bytes[7] | (std::uint32_t{bytes[8]} << 8) | (std::uint32_t{bytes[9]} << 16);
    }
    out.packet_bytes = out.header_bytes + out.payload_bytes + kChecksum_bytes +
                       (out.is_signed ? kSignature_bytes : 0);
    return out;
  }
};

void Parser::add(std::span<const std::uint8_t> bytes) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

std::span<const std::uint8_t> Parser::rest() const {
  return std::span(buffer_).subspan(begin_);
}

std::optional<Packet> Parser::next() {
  while (!rest().empty()) {
    const std::span<const std::uint8_t> bytes = rest();
    const bool has_magic = bytes[0] == kMagic1 || bytes[0] == kMagic2;
    if (has_magic && bytes.size() < (bytes[0] == kMagic1 ? kHeader1_bytes : kHeader2_bytes)) break;
    const std::optional<Header> header = has_magic ? Header::read(bytes) : std::nullopt;
    if (!header) {
      in_sync_ = false;
      ++begin_;
      ++counts_.skipped_bytes;
      continue;
    }
    if (bytes.size() < header->packet_bytes) break;
    const std::optional<std::uint8_t> extra = crc_extra(header->id);
    if (!extra) {
      // its checksum cannot be verified: trust its length only between packets
      const bool is_plausible = in_sync_ && (bytes.size() == header->packet_bytes ||
                                             bytes[header->packet_bytes] == kMagic1 ||
                                             bytes[header->packet_bytes] == kMagic2);
      in_sync_ = is_plausible;
      if (is_plausible) count_sequence(*header);
      begin_ += is_plausible ? header->packet_bytes : 1;
      ++(is_plausible ? counts_.unknown : counts_.skipped_bytes);
      continue;
    }
    if (!has_valid_checksum(*header, *extra)) {
      in_sync_ = false;
      ++counts_.checksum_errors;
      ++counts_.skipped_bytes;
      ++begin_;
      continue;
    }
    Packet packet{.id = header->id,
                  .system = header->system,
                  .component = header->component,
                  .sequence = header->sequence,
                  .is_signed = header->is_signed};
    const auto payload = bytes.subspan(header->header_bytes, header->payload_bytes);
    std::ranges::copy(payload, packet.payload.begin());
    for (const std::uint8_t byte : bytes.first(header->packet_bytes)) packet.raw.push(byte);
    begin_ += header->packet_bytes;
    count_sequence(*header);
    ++counts_.packets;
    in_sync_ = true;
    return packet;
  }
  return std::nullopt;
}

bool Parser::has_valid_checksum(const Header& header, std::uint8_t crc_extra) const {
  const std::span<const std::uint8_t> bytes = rest();
  const std::size_t end = header.header_bytes + header.payload_bytes;
  Checksum checksum;
  for (const std::uint8_t byte : bytes.subspan(1, end - 1)) checksum.add(byte);
  checksum.add(crc_extra);
  return (bytes[end] | (bytes[end + 1] << 8)) == checksum.value();
}

// Packets of unknown messages count, too: all messages of a sender share one sequence.
void Parser::count_sequence(const Header& header) {
  const auto [last, is_new] =
      sequences_.try_emplace({header.system, header.component}, header.sequence);
  if (is_new) return;
  counts_.lost += static_cast<std::uint8_t>(header.sequence - last->second - 1);
  last->second = header.sequence;
}

}  // namespace stillkite::mavlink
