#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/import/imported_flight.hpp"
#include "io/import/video_telemetry.hpp"
#include "io/recording_format.hpp"

namespace stillkite {

struct ImportOptions {
  std::optional<std::filesystem::path> calibration;
  std::optional<double> horizontal_fov_deg;  ///< of a pinhole camera, replaces the nominal lens
  double log_start_s = 0;              ///< time in the video at which the log or telemetry starts
  std::function<void()> poll = [] {};  ///< called often; may throw to end the import
};

struct RecordedLog {
  std::filesystem::path file;
  RecordingFormat format;
};

/// Files of one flight: a video, a log, or both.
struct Recording {
  std::optional<ImportedVideo> video;
  std::optional<RecordedLog> log;
  std::optional<std::string> image_topic;  ///< of a ROS recording without a video
  ImportedFlight flight;
  double time_offset_s = 0;  ///< t_video = t_flight + time_offset_s
};

/// Reads the files, formats by content. Subtitles next to a video, and a video next to subtitles,
/// have the same name up to the extension. A log replaces the sensors of the video's own telemetry,
/// not its nominal lens. Throws
/// InputError on a file of an unknown format, on two videos or logs, and without any reading.
[[nodiscard]] Recording read_recording(const std::vector<std::filesystem::path>& files,
                                       const ImportOptions& options);

}  // namespace stillkite
