#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/import/recording.hpp"

namespace stillkite {

/// Writes the flight as a new folder: flight.yaml, and the files of docs/import.md that have a
/// reading. Stamps are those of the recording. Returns the notes of the import, those of the
/// readers first. Throws InputError as OutputFolder.
std::vector<ImportNote> write_flight_folder(const Recording& recording,
                                            const ImportOptions& options,
                                            const std::filesystem::path& out);

}  // namespace stillkite
