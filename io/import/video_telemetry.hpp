#pragma once

#include <filesystem>
#include <optional>

#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Video of a recording, as coded, and rotated as its images are read.
struct ImportedVideo {
  std::filesystem::path file;
  int width_px = 0, height_px = 0;
  std::optional<double> duration_s;
  /// Telemetry in a track of GoPro (gpmd) or in DJI's subtitles; nullopt without any.
  std::optional<ImportedFlight> telemetry;
};

/// Size and telemetry of a video; images are not decoded. A telemetry track without a reading gives
/// a note. Throws InputError if the file is no video.
[[nodiscard]] ImportedVideo read_imported_video(const std::filesystem::path& file,
                                                bool with_telemetry);

}  // namespace stillkite
