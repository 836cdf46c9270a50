#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/import/calibration_section.hpp"
#include "io/import/local_frame.hpp"
#include "io/import/recording.hpp"

namespace stillkite {

/// Values that write_flight_folder derives from a recording.
struct FlightFiles {
  TimeSeries<Vector6d> imu;
  std::optional<LocalFrame> frame;  ///< of the positions, if they are a truth
  std::optional<ImageSize> images;  ///< of the video or of cam0
};

/// Text of flight.yaml in the folder `out`, for the files of write_flight_folder. Values that the
/// recording does not contain are assumed or left out, each with a note.
[[nodiscard]] std::string flight_yaml(const Recording& recording, const ImportOptions& options,
                                      const FlightFiles& files, const std::filesystem::path& out,
                                      std::vector<ImportNote>& notes);

}  // namespace stillkite
