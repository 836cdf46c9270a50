#include "live/record/flight_files.hpp"

extern "C" {
#include <libavutil/mem.h>
}

#include <fmt/format.h>

#include <charconv>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>
#include <span>

namespace stillkite {
namespace fs = std::filesystem;
namespace {

std::string to_hex(std::span<const std::uint8_t> bytes) {
  return fmt::format("{:02x}", fmt::join(bytes, ""));
}

// Cells of one row; the first invalid one clears `is_valid`.
class Row {
 public:
  explicit Row(std::string_view line) : rest_(line) {}

  [[nodiscard]] bool is_valid() const { return is_valid_ && !rest_; }

  std::string_view word() {
    if (!rest_) {
      is_valid_ = false;
      return {};
    }
    const std::size_t end = rest_->find(',');
    const std::string_view cell = rest_->substr(0, end);
    if (end == std::string_view::npos) {
      rest_.reset();
    } else {
      rest_->remove_prefix(end + 1);
    }
    return cell;
  }

  template <typename T>
  T number() {
    const std::string_view cell = word();
    T value{};
    const auto result = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    is_valid_ = is_valid_ && result.ec == std::errc() && result.ptr == cell.data() + cell.size();
    return value;
  }
  std::int64_t whole() { return number<std::int64_t>(); }

  std::vector<std::uint8_t> bytes() {
    const std::string_view cell = word();
    std::vector<std::uint8_t> out(cell.size() / 2);
    is_valid_ = is_valid_ && cell.size() % 2 == 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const char* digits = cell.data() + 2 * i;
      const auto result = std::from_chars(digits, digits + 2, out[i], 16);
      is_valid_ = is_valid_ && result.ptr == digits + 2;
    }
    return out;
  }

  template <typename Enum>
  Enum enumerator() {
    const std::string_view cell = word();
    for (const auto& [value, name] : EnumNames<Enum>::value) {
      if (name == cell) return value;
    }
    is_valid_ = false;
    return {};
  }

  /// False at the end of the row, as in records of earlier versions.
  [[nodiscard]] bool has_more() const { return rest_.has_value(); }

  void reject() { is_valid_ = false; }

 private:
  std::optional<std::string_view> rest_;
  bool is_valid_ = true;
};

// Calls `read_row` for each complete row.
void read_rows(const fs::path& file, const std::function<void(Row&)>& read_row) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string() + ": cannot be read; it is part of a flight record");
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (stream.eof()) return;  // no line break: the process was killed while it wrote
    if (line.starts_with('#')) continue;
    Row row(line);
    read_row(row);
    if (row.is_valid()) continue;
    throw InputError(
        fmt::format("{}:{}: invalid row; the flight record is damaged", file.string(), number));
  }
}

RecordedSession read_session(Row& row) {
  RecordedSession session{.codec = LibavHandle<AVCodecParameters>(avcodec_parameters_alloc())};
  AVCodecParameters& codec = *session.codec;
  const AVCodecDescriptor* descriptor =
      avcodec_descriptor_get_by_name(std::string(row.word()).c_str());
  if (descriptor == nullptr) {
    row.reject();
    return session;
  }
  codec.codec_type = AVMEDIA_TYPE_VIDEO;
  codec.codec_id = descriptor->id;
  codec.codec_tag = row.number<std::uint32_t>();
  codec.width = row.number<int>();
  codec.height = row.number<int>();
  codec.format = row.number<int>();
  session.time_base = {row.number<int>(), row.number<int>()};
  const std::vector<std::uint8_t> extra = row.bytes();
  if (extra.empty()) return session;
  codec.extradata =
      static_cast<std::uint8_t*>(av_mallocz(extra.size() + AV_INPUT_BUFFER_PADDING_SIZE));
  if (codec.extradata == nullptr) throw std::bad_alloc();
  std::memcpy(codec.extradata, extra.data(), extra.size());
  codec.extradata_size = static_cast<int>(extra.size());
  return session;
}

}  // namespace

std::string sessions_header() {
  return "#codec,tag,width [px],height [px],pixel_format,time_base_num,time_base_den,extradata\n";
}
std::string packets_header() {
  return "#session,offset [B],size [B],flags,pts,dts,arrival [ns]\n";
}
std::string frames_header() {
  return "#frame,outcome,timestamp [ns],stamp_sigma [s],telemetry,decision [ns]\n";
}
std::string telemetry_header() {
  return "#arrival [ns],bytes,source\n";
}

std::string session_row(const AVCodecParameters& codec, AVRational time_base) {
  const std::span extra(codec.extradata, static_cast<std::size_t>(codec.extradata_size));
  return fmt::format("{},{},{},{},{},{},{},{}\n", avcodec_get_name(codec.codec_id), codec.codec_tag,
                     codec.width, codec.height, codec.format, time_base.num, time_base.den,
                     to_hex(extra));
}

std::string packet_row(const RecordedPacket& packet) {
  return fmt::format("{},{},{},{},{},{},{}\n", packet.session, packet.offset, packet.size,
                     packet.flags, packet.pts, packet.dts, packet.arrival.ns);
}

// {} prints a double with the digits that restore it.
std::string frame_row(const RecordedFrame& frame) {
  return fmt::format("{},{},{},{},{},{}\n", frame.index, name_of(frame.outcome), frame.stamp.ns,
                     frame.stamp_sigma_s, frame.telemetry, frame.decision.ns);
}

std::string message_row(const RecordedMessage& message) {
  return fmt::format("{},{},{}\n", message.arrival.ns, to_hex(message.bytes),
                     name_of(message.source));
}

std::vector<RecordedSession> read_sessions(const fs::path& folder) {
  std::vector<RecordedSession> out;
  read_rows(folder / kSessionsFile, [&](Row& row) { out.push_back(read_session(row)); });
  return out;
}

std::vector<RecordedPacket> read_packets(const fs::path& folder) {
  std::vector<RecordedPacket> out;
  read_rows(folder / kPacketsFile, [&](Row& row) {
    RecordedPacket& packet = out.emplace_back();
    for (std::int64_t* value : {&packet.session, &packet.offset, &packet.size, &packet.flags,
                                &packet.pts, &packet.dts, &packet.arrival.ns}) {
      *value = row.whole();
    }
  });
  return out;
}

std::vector<RecordedFrame> read_frames(const fs::path& folder) {
  std::vector<RecordedFrame> out;
  read_rows(folder / kFramesFile, [&](Row& row) {
    RecordedFrame& frame = out.emplace_back();
    frame.index = row.whole();
    frame.outcome = row.enumerator<FrameOutcome>();
    frame.stamp.ns = row.whole();
    frame.stamp_sigma_s = row.number<double>();
    frame.telemetry = row.whole();
    frame.decision = row.has_more() ? Timestamp{row.whole()} : frame.stamp;
  });
  return out;
}

std::vector<RecordedMessage> read_messages(const fs::path& folder) {
  std::vector<RecordedMessage> out;
  read_rows(folder / kTelemetryFile, [&](Row& row) {
    RecordedMessage& message = out.emplace_back();
    message.arrival.ns = row.whole();
    message.bytes = row.bytes();
    if (row.has_more()) message.source = row.enumerator<MessageSource>();
  });
  return out;
}

}  // namespace stillkite
