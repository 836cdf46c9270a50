#include "app/results_folder.hpp"

#include "io/flight_inputs.hpp"
#include "io/output_file.hpp"

namespace stillkite {

namespace fs = std::filesystem;

fs::path results_folder(const fs::path& asked_for, const fs::path& config) {
  if (!asked_for.empty()) return asked_for;
  const fs::path flight = fs::absolute(config).lexically_normal().parent_path().filename();
  const bool is_of_flight = config.filename() == "run.yaml" && !flight.empty();
  return fs::path("out") / (is_of_flight ? "run-" + flight.string() : config.stem().string());
}

void protect_inputs_of_run(const fs::path& folder, const fs::path& config_file,
                           const RunConfig& config) {
  std::vector<fs::path> inputs = named_files(config);
  inputs.push_back(config_file);
  protect_inputs(folder,
                 {"estimates.csv", "trajectory.tum", "commands.csv", "overlay.mp4", "summary.json",
                  "comparison.json", "report.html"},
                 inputs);
}

}  // namespace stillkite
