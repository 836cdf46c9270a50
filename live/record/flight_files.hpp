#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"
#include "geometry/time.hpp"
#include "live/video/libav_handles.hpp"

// Files of a recorded flight (docs/live.md). Each is appended row by row; a last row without its
// line break is incomplete and ignored.

namespace stillkite {

inline constexpr const char* kFlightConfig = "flight.yaml";
inline constexpr const char* kSessionsFile = "sessions.csv";    ///< openings of the video
inline constexpr const char* kPacketsFile = "packets.csv";      ///< index of the coded video
inline constexpr const char* kVideoFile = "video.bin";          ///< coded packets, concatenated
inline constexpr const char* kFramesFile = "frames.csv";        ///< decoded images
inline constexpr const char* kTelemetryFile = "telemetry.csv";  ///< messages
inline constexpr const char* kEstimatesFile = "estimates.csv";
inline constexpr const char* kCommandsFile = "commands.csv";

/// Use of a decoded image.
enum class FrameOutcome { used, replaced, settling, damaged, out_of_order, resized };
template <>
struct EnumNames<FrameOutcome> {
  static constexpr auto value = std::to_array<std::pair<FrameOutcome, std::string_view>>(
      {{FrameOutcome::used, "used"},
       {FrameOutcome::replaced, "replaced"},
       {FrameOutcome::settling, "settling"},
       {FrameOutcome::damaged, "damaged"},
       {FrameOutcome::out_of_order, "out_of_order"},
       {FrameOutcome::resized, "resized"}});
};

/// Origin of a message.
enum class MessageSource { mavlink, station, operator_command, sensors };
template <>
struct EnumNames<MessageSource> {
  static constexpr auto value = std::to_array<std::pair<MessageSource, std::string_view>>(
      {{MessageSource::mavlink, "mavlink"},
       {MessageSource::station, "station"},
       {MessageSource::operator_command, "operator"},
       {MessageSource::sensors, "sensors"}});
};

/// Opening of the video source: decoder parameters of the packets that follow.
struct RecordedSession {
  LibavHandle<AVCodecParameters> codec;
  AVRational time_base{0, 1};
};

struct RecordedPacket {
  std::int64_t session = 0;
  std::int64_t offset = 0, size = 0;  ///< bytes of video.bin
  std::int64_t flags = 0, pts = 0, dts = 0;
  Timestamp arrival;
};

struct RecordedFrame {
  std::int64_t index = 0;  ///< of the decoded image, from 0 over all sessions
  FrameOutcome outcome = FrameOutcome::used;
  Timestamp stamp;
  double stamp_sigma_s = 0;
  std::int64_t telemetry = 0;  ///< number of messages before its estimate
  Timestamp decision;          ///< time at which the estimator took it
};

struct RecordedMessage {
  Timestamp arrival;
  std::vector<std::uint8_t> bytes;
  MessageSource source = MessageSource::mavlink;
};

/// Header lines, newline included.
[[nodiscard]] std::string sessions_header();
[[nodiscard]] std::string packets_header();
[[nodiscard]] std::string frames_header();
[[nodiscard]] std::string telemetry_header();

/// Rows, newline included.
[[nodiscard]] std::string session_row(const AVCodecParameters& codec, AVRational time_base);
[[nodiscard]] std::string packet_row(const RecordedPacket& packet);
[[nodiscard]] std::string frame_row(const RecordedFrame& frame);
[[nodiscard]] std::string message_row(const RecordedMessage& message);

/// Complete rows of a file. Throws InputError with file and line if a row is invalid.
[[nodiscard]] std::vector<RecordedSession> read_sessions(const std::filesystem::path& folder);
[[nodiscard]] std::vector<RecordedPacket> read_packets(const std::filesystem::path& folder);
[[nodiscard]] std::vector<RecordedFrame> read_frames(const std::filesystem::path& folder);
[[nodiscard]] std::vector<RecordedMessage> read_messages(const std::filesystem::path& folder);

}  // namespace stillkite
