#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {

/// Recordings that `stillkite import` converts.
enum class RecordingFormat { mp4, subtitles, ulog, dataflash, tlog, mcap, rosbag, ros_database };
template <>
struct EnumNames<RecordingFormat> {
  static constexpr auto value = std::to_array<std::pair<RecordingFormat, std::string_view>>(
      {{RecordingFormat::mp4, "MP4 video"},
       {RecordingFormat::subtitles, "subtitle file (SRT)"},
       {RecordingFormat::ulog, "PX4 log (ULog)"},
       {RecordingFormat::dataflash, "ArduPilot log (DataFlash)"},
       {RecordingFormat::tlog, "MAVLink telemetry log (tlog)"},
       {RecordingFormat::mcap, "MCAP recording"},
       {RecordingFormat::rosbag, "ROS 1 bag"},
       {RecordingFormat::ros_database, "ROS 2 bag (sqlite3)"}});
};

/// Format by the first bytes of a file; nullopt for any other.
[[nodiscard]] std::optional<RecordingFormat> recording_format(std::string_view head);

/// Format of a file; nullopt also if it cannot be read.
[[nodiscard]] std::optional<RecordingFormat> recording_format_of(const std::filesystem::path& file);

/// For readers of text: throws InputError "FILE: recognized as PX4 log (ULog); convert it:
/// stillkite import FILE --out FOLDER" for a recording.
void reject_recording(const std::filesystem::path& file);

}  // namespace stillkite
