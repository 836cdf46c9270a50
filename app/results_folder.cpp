#include "app/results_folder.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/dataset/flight_inputs.hpp"
#include "io/results/output_file.hpp"
#include "io/results/part_file.hpp"

namespace stillkite {

namespace fs = std::filesystem;
namespace {

constexpr std::initializer_list<const char*> kResults{
    "summary.json",   "report.html",  "comparison.json", "estimates.csv",
    "trajectory.tum", "commands.csv", "overlay.mp4"};

void remove_results(const fs::path& folder, const std::vector<fs::path>& inputs) {
  for (const char* name : kResults) {
    const fs::path file = folder / name;
    const auto is_file = [&](const fs::path& input) {
      std::error_code ignored;
      return fs::equivalent(file, input, ignored);
    };
    std::error_code ignored;
    if (!fs::is_directory(file, ignored) && std::ranges::none_of(inputs, is_file)) {
      fs::remove(file, ignored);
    }
    remove_stale_parts(file);
  }
}

// Names of the estimators of a comparison; empty for another file.
std::vector<std::string> compared_estimators(const fs::path& comparison_json) {
  std::vector<std::string> names;
  const auto parsed = nlohmann::json::parse(std::ifstream(comparison_json), nullptr, false);
  if (!parsed.is_object() || !parsed.contains("estimators")) return names;
  for (const nlohmann::json& estimator : parsed["estimators"]) {
    // only a comparison of runs has frames
    if (!estimator.is_object() || !estimator.contains("frames")) continue;
    if (!estimator.contains("name") || !estimator["name"].is_string()) continue;
    const fs::path name = estimator["name"].get<std::string>();
    if (name != name.filename() || name.empty() || name == "." || name == "..") continue;
    names.push_back(name.string());
  }
  return names;
}

}  // namespace

std::string flight_name(const fs::path& config) {
  const fs::path folder = fs::absolute(config).lexically_normal().parent_path().filename();
  return (config.filename() == "run.yaml" && !folder.empty() ? folder : config.stem()).string();
}

fs::path results_folder(const fs::path& requested, const fs::path& config) {
  if (!requested.empty()) return requested;
  return fs::path("out") /
         (config.filename() == "run.yaml" ? "run-" + flight_name(config) : flight_name(config));
}

std::vector<fs::path> inputs_of_run(const fs::path& config_file, const RunConfig& config) {
  std::vector<fs::path> inputs = named_files(config);
  inputs.push_back(config_file);
  return inputs;
}

void remove_earlier_results(const fs::path& folder, const std::vector<fs::path>& inputs) {
  std::error_code ignored;
  for (const std::string& name : compared_estimators(folder / "comparison.json")) {
    if (fs::is_symlink(folder / name, ignored)) continue;
    remove_results(folder / name, inputs);
    fs::remove(folder / name, ignored);  // only an empty folder
  }
  remove_results(folder, inputs);
}

void protect_inputs_of_run(const fs::path& folder, const fs::path& config_file,
                           const RunConfig& config) {
  protect_inputs(folder, kResults, inputs_of_run(config_file, config));
}

}  // namespace stillkite
