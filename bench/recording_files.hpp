#pragma once

#include <filesystem>

#include "recording.hpp"

namespace stillkite::bench {

/// Writes a recording as a new folder in EuRoC layout with lossless images; absent series have no
/// file. Without poses there is no velocity.csv.
void write_recording(const Recording& recording, const std::filesystem::path& folder);

}  // namespace stillkite::bench
