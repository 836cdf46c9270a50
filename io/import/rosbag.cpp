#include "io/import/rosbag.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/import/decompression.hpp"

namespace stillkite {
namespace {

constexpr std::size_t kVersionBytes = 13;  // "#ROSBAG V2.0\n"
constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 20;

std::string_view bag_text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Fields "name=value" of a header, each after its length.
std::map<std::string_view, Bytes> header_fields(Bytes header) {
  std::map<std::string_view, Bytes> out;
  while (header.size() >= 4) {
    const std::size_t length = little_endian<std::uint32_t>(header, 0);
    if (length > header.size() - 4) break;
    const Bytes field = header.subspan(4, length);
    const std::size_t equals = bag_text(field).find('=');
    if (equals != std::string_view::npos) {
      out.insert_or_assign(bag_text(field).substr(0, equals), field.subspan(equals + 1));
    }
    header = header.subspan(4 + length);
  }
  return out;
}

Bytes field_of(const std::map<std::string_view, Bytes>& fields, std::string_view name) {
  const auto found = fields.find(name);
  return found == fields.end() ? Bytes() : found->second;
}

enum BagOpcode : std::uint8_t { message_data = 0x02, bag_chunk = 0x05, connection = 0x07 };

class RosbagReader {
 public:
  RosbagReader(const std::filesystem::path& file, const TakeRosMessage& take)
      : source_(file), take_(take) {}

  std::size_t read() {
    source_.skip(kVersionBytes);
    std::vector<std::uint8_t> header, data;
    while (true) {
      if (source_.peek(1).empty()) return damaged_;
      if (!read_part(header, kMaxHeaderBytes) || !read_part(data, kMaxChunkBytes)) break;
      take_record(header, data, true);
    }
    return damaged_ + 1;
  }

 private:
  struct Connection {
    std::string topic, type;
  };

  // Bytes after their length.
  bool read_part(std::vector<std::uint8_t>& part, std::uint64_t max_bytes) {
    const Bytes head = source_.peek(4);
    if (head.size() < 4) return false;
    const std::size_t length = little_endian<std::uint32_t>(head, 0);
    source_.skip(4);
    return length <= max_bytes && source_.read(part, length);
  }

  void take_record(Bytes header, Bytes data, bool may_be_chunk) {
    const std::map<std::string_view, Bytes> fields = header_fields(header);
    const Bytes op = field_of(fields, "op");
    if (op.size() != 1) return;
    const auto id = little_endian<std::uint32_t>(field_of(fields, "conn"), 0);
    if (op[0] == connection) {
      const std::map<std::string_view, Bytes> about = header_fields(data);
      connections_[id] = {.topic = std::string(bag_text(field_of(fields, "topic"))),
                          .type = std::string(bag_text(field_of(about, "type")))};
    } else if (op[0] == message_data) {
      const auto found = connections_.find(id);
      if (found == connections_.end()) return;
      const Bytes time = field_of(fields, "time");
      const Timestamp logged{std::int64_t{1'000'000'000} * little_endian<std::uint32_t>(time, 0) +
                             little_endian<std::uint32_t>(time, 4)};
      take_({.topic = found->second.topic,
             .type = found->second.type,
             .logged = logged,
             .data = data,
             .is_cdr = false});
    } else if (op[0] == bag_chunk && may_be_chunk) {
      take_chunk(fields, data);
    }
  }

  void take_chunk(const std::map<std::string_view, Bytes>& fields, Bytes data) {
    const std::optional<std::vector<std::uint8_t>> records =
        decompress(data, bag_text(field_of(fields, "compression")),
                   little_endian<std::uint32_t>(field_of(fields, "size"), 0));
    if (!records) {
      ++damaged_;
      return;
    }
    Bytes rest(*records);
    const auto take_part = [&rest]() -> std::optional<Bytes> {
      if (rest.size() < 4) return std::nullopt;
      const std::size_t length = little_endian<std::uint32_t>(rest, 0);
      if (length > rest.size() - 4) return std::nullopt;
      const Bytes part = rest.subspan(4, length);
      rest = rest.subspan(4 + length);
      return part;
    };
    while (true) {
      const std::optional<Bytes> header = take_part();
      const std::optional<Bytes> body = header ? take_part() : std::nullopt;
      if (!body) break;
      take_record(*header, *body, false);
    }
  }

  ByteSource source_;
  const TakeRosMessage& take_;
  std::map<std::uint32_t, Connection> connections_;
  std::size_t damaged_ = 0;
};

}  // namespace

std::size_t read_rosbag(const std::filesystem::path& file, const TakeRosMessage& take) {
  return RosbagReader(file, take).read();
}

}  // namespace stillkite
