#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/import/imported_flight.hpp"
#include "io/import/recording.hpp"

namespace stillkite {

struct ImageSize {
  int width_px = 0, height_px = 0;
};

/// Section `calibration` of flight.yaml: `path`, the quoted path of the option --calibration, else
/// the calibration in the recording, else a nominal lens for images of a known size; empty without
/// any. Throws InputError if the option's calibration is for images of another size.
[[nodiscard]] std::string calibration_section(const ImportedFlight& flight,
                                              const ImportOptions& options,
                                              const std::optional<ImageSize>& images,
                                              const std::string& path,
                                              std::vector<ImportNote>& notes);

}  // namespace stillkite
