#include "app/recorded_config.hpp"

#include <string>

#include "io/config/config_printing.hpp"
#include "io/results/output_file.hpp"
#include "io/text_file.hpp"
#include "live/record/flight_files.hpp"
#include "live/stream/stream_address.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

void copy_into(const fs::path& folder, std::optional<fs::path>& path, const std::string& name) {
  if (!path) return;
  const fs::path file = fs::path(name) += path->extension();
  write_file(folder / file, read_bytes(*path));
  path = file;
}

}  // namespace

void check_recorded_files(const FlyConfig& config) {
  for (const auto& file : {config.calibration.path, config.calibration.mask_path}) {
    if (file) static_cast<void>(read_bytes(*file));
  }
}

void write_recorded_config(FlyConfig config, const fs::path& folder) {
  config.source.path = without_password(config.source.path);
  copy_into(folder, config.calibration.path, "calibration");
  copy_into(folder, config.calibration.mask_path, "mask");
  write_file(folder / kFlightConfig, print_config(config));
}

}  // namespace stillkite
