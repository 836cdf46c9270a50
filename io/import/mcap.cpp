#include "io/import/mcap.hpp"

#include <map>
#include <optional>
#include <string>

#include "io/import/decompression.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kMagicBytes = 8, kRecordHead = 9;
enum Opcode : std::uint8_t {
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  data_end = 0x0F
};

// Fields of a record; after its end numbers are 0 and texts empty.
class RecordFields {
 public:
  explicit RecordFields(Bytes bytes) : bytes_(bytes) {}

  template <typename T>
  T next() {
    const bool fits = at_ <= bytes_.size() && bytes_.size() - at_ >= sizeof(T);
    const T value = fits ? little_endian<T>(bytes_, at_) : T{};
    at_ += sizeof(T);
    return value;
  }
  std::string_view text() {
    const std::size_t length = next<std::uint32_t>();
    const Bytes part = rest().first(std::min(length, rest().size()));
    at_ += part.size();
    return {reinterpret_cast<const char*>(part.data()), part.size()};
  }
  [[nodiscard]] Bytes rest() const { return bytes_.subspan(std::min(at_, bytes_.size())); }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
};

class McapReader {
 public:
  McapReader(const std::filesystem::path& file, const TakeRosMessage& take)
      : source_(file), take_(take) {}

  std::size_t read() {
    source_.skip(kMagicBytes);
    std::vector<std::uint8_t> record;
    for (Bytes head; (head = source_.peek(kRecordHead)).size() == kRecordHead;) {
      const std::uint8_t opcode = head[0];
      const auto length = little_endian<std::uint64_t>(head, 1);
      source_.skip(kRecordHead);
      if (opcode == data_end) return damaged_;
      if (opcode != schema && opcode != channel && opcode != message && opcode != chunk) {
        source_.skip(length);
        continue;
      }
      if (length > kMaxChunkBytes || !source_.read(record, static_cast<std::size_t>(length))) break;
      take_record(opcode, record);
    }
    return damaged_ + 1;
  }

 private:
  struct Channel {
    std::string topic, type;
    bool is_cdr = true, is_ros = false;
  };

  void take_record(std::uint8_t opcode, Bytes bytes) {
    RecordFields fields(bytes);
    if (opcode == schema) {
      const auto id = fields.next<std::uint16_t>();
      types_[id] = ros1_type(fields.text());
    } else if (opcode == channel) {
      const auto id = fields.next<std::uint16_t>();
      const auto type = types_.find(fields.next<std::uint16_t>());
      Channel described{.topic = std::string(fields.text())};
      const std::string_view encoding = fields.text();
      described.is_cdr = encoding == "cdr";
      described.is_ros = described.is_cdr || encoding == "ros1";
      if (type != types_.end()) described.type = type->second;
      channels_[id] = std::move(described);
    } else if (opcode == message) {
      const auto found = channels_.find(fields.next<std::uint16_t>());
      if (found == channels_.end() || !found->second.is_ros) return;
      (void)fields.next<std::uint32_t>();
      const auto logged = fields.next<std::uint64_t>();
      (void)fields.next<std::uint64_t>();
      take_({.topic = found->second.topic,
             .type = found->second.type,
             .logged = time_of_recording(logged),
             .data = fields.rest(),
             .is_cdr = found->second.is_cdr});
    } else if (opcode == chunk) {
      take_chunk(fields);
    }
  }

  void take_chunk(RecordFields& fields) {
    (void)fields.next<std::uint64_t>();
    (void)fields.next<std::uint64_t>();
    const auto size = fields.next<std::uint64_t>();
    (void)fields.next<std::uint32_t>();
    const std::string_view compression = fields.text();
    const auto stored = fields.next<std::uint64_t>();
    const std::optional<std::vector<std::uint8_t>> records =
        fields.rest().size() == stored ? decompress(fields.rest(), compression, size)
                                       : std::nullopt;
    if (!records) {
      ++damaged_;
      return;
    }
    Bytes rest(*records);
    while (rest.size() >= kRecordHead) {
      const auto length = little_endian<std::uint64_t>(rest, 1);
      if (length > rest.size() - kRecordHead) break;
      // a chunk contains no chunk
      if (rest[0] != chunk)
        take_record(rest[0], rest.subspan(kRecordHead, static_cast<std::size_t>(length)));
      rest = rest.subspan(kRecordHead + static_cast<std::size_t>(length));
    }
  }

  ByteSource source_;
  const TakeRosMessage& take_;
  std::map<std::uint16_t, std::string> types_;
  std::map<std::uint16_t, Channel> channels_;
  std::size_t damaged_ = 0;
};

}  // namespace

std::size_t read_mcap(const std::filesystem::path& file, const TakeRosMessage& take) {
  return McapReader(file, take).read();
}

}  // namespace stillkite
