#include "io/recording_format.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <fstream>

namespace stillkite {
namespace {

constexpr std::size_t kHeadBytes = 4096;

// Size of the first box, below 16 MiB or in a later field, and its type: file type, or in old files
// the media data or index.
bool is_mp4(std::string_view head) {
  if (head.size() < 12 || head[0] != 0) return false;
  const std::string_view type = head.substr(4, 4);
  return type == "ftyp" || type == "moov" || type == "mdat" || type == "wide";
}

// First cue: a number, then "00:00:00,000 --> ...".
bool is_subtitles(std::string_view head) {
  if (head.starts_with("\xef\xbb\xbf")) head.remove_prefix(3);
  const std::size_t number = head.find_first_not_of(" \t\r\n");
  if (number == std::string_view::npos) return false;
  const std::size_t end = head.find_first_not_of("0123456789", number);
  if (end == number || end == std::string_view::npos) return false;
  const std::size_t time = head.find_first_not_of(" \t\r\n", end);
  if (time == std::string_view::npos) return false;
  const std::string_view line = head.substr(time, head.find('\n', time) - time);
  return line.size() >= 17 && line[2] == ':' && line.find("-->") != std::string_view::npos;
}

// Records of an eight-byte stamp in microseconds since 1970, most significant byte first, and a
// MAVLink packet. The stamp must be in 1990 to 2100, and the next record begins where the packet
// ends.
bool is_tlog(std::string_view head) {
  constexpr std::uint64_t kFrom_us = 631'152'000'000'000, kTo_us = 4'102'444'800'000'000;
  const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(head[at]); };
  std::size_t at = 0;
  for (int record = 0; record < 2; ++record) {
    if (at + 11 > head.size()) return record > 0;
    std::uint64_t stamp_us = 0;
    for (std::size_t i = 0; i < 8; ++i) stamp_us = stamp_us << 8 | byte(at + i);
    if (stamp_us < kFrom_us || stamp_us > kTo_us) return false;
    const std::size_t payload = byte(at + 9);
    if (byte(at + 8) == 0xFE) {
      at += 8 + 8 + payload;
    } else if (byte(at + 8) == 0xFD) {
      at += 8 + 12 + payload + ((byte(at + 10) & 1) != 0 ? 13 : 0);
    } else {
      return false;
    }
  }
  return true;
}

}  // namespace

std::optional<RecordingFormat> recording_format(std::string_view head) {
  if (head.starts_with("ULog\x01\x12\x35")) return RecordingFormat::ulog;
  if (head.starts_with("\xa3\x95")) return RecordingFormat::dataflash;
  if (head.starts_with("\x89MCAP0\r\n")) return RecordingFormat::mcap;
  if (head.starts_with("#ROSBAG V2.0\n")) return RecordingFormat::rosbag;
  if (head.starts_with("SQLite format 3")) return RecordingFormat::ros_database;
  if (is_mp4(head)) return RecordingFormat::mp4;
  if (is_tlog(head)) return RecordingFormat::tlog;
  if (is_subtitles(head)) return RecordingFormat::subtitles;
  return std::nullopt;
}

std::optional<RecordingFormat> recording_format_of(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  std::ifstream stream(file, std::ios::binary);
  std::string head(kHeadBytes, '\0');
  stream.read(head.data(), std::ssize(head));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  return recording_format(head);
}

void reject_recording(const std::filesystem::path& file) {
  if (const std::optional<RecordingFormat> format = recording_format_of(file)) {
    throw InputError(
        fmt::format("{}: recognized as {}; convert it: stillkite import {} --out FOLDER",
                    file.string(), name_of(*format), file.string()));
  }
}

}  // namespace stillkite
