#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/import/local_frame.hpp"
#include "io/import/recording.hpp"

namespace stillkite {

/// Text of flight.yaml in the folder `out`, for the files of write_flight_folder. Values that the
/// recording does not contain are assumed or left out, each with a note. `frame`: of the positions,
/// if they are a truth.
[[nodiscard]] std::string flight_yaml(const Recording& recording, const ImportOptions& options,
                                      const TimeSeries<Vector6d>& imu,
                                      const std::optional<LocalFrame>& frame,
                                      const std::filesystem::path& out,
                                      std::vector<ImportNote>& notes);

}  // namespace stillkite
