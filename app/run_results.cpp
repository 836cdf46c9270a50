#include "app/run_results.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "app/run_evaluation.hpp"
#include "io/config/config_printing.hpp"
#include "io/report/report.hpp"
#include "io/results/json_text.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

// "1.23 m" or "unknown".
std::string figure(const json& value, const char* unit) {
  return value.is_number() ? fmt::format("{:.4g} {}", value.get<double>(), unit) : "unknown";
}

// " (3 lost, 1 frozen)" for frames without measurement, or "".
std::string reasons(const json& verdicts) {
  std::string list;
  for (const auto& [verdict, name] : EnumNames<Verdict>::value) {
    const auto count = verdicts[std::string(name)].get<std::int64_t>();
    if (is_measured(verdict) || count == 0) continue;
    list += fmt::format("{}{} {}", list.empty() ? " (" : ", ", count, name);
  }
  return list.empty() ? list : list + ')';
}

void print_final_position(const NavigationEstimate& last) {
  const bool is_metric = last.scale != ScaleSource::none;
  if (!is_metric && !is_in_heights(last)) {
    fmt::print("final        no position (scale none)\n");
    return;
  }
  const Eigen::Vector3d& position = last.world_from_body.translation;
  fmt::print(
      "final        x {:.3f}, y {:.3f}, z {:.3f} {}{}\n", position.x(), position.y(), position.z(),
      is_metric ? "m" : "initial heights",
      is_measured(last.verdict) ? "" : fmt::format(" (predicted: {})", name_of(last.verdict)));
}

}  // namespace

json write_run_results(const std::filesystem::path& folder, const RunConfig& config,
                       const FlightInputs& inputs, const RunRecord& record, const RunFacts& facts) {
  const json summary = run_summary(
      record.tally, facts,
      run_evaluation(inputs, config.truth, record.motions, record.reference_errors.error()));
  write_file(folder / "summary.json", json_text(summary) + '\n');
  write_report(folder / "report.html",
               {.title = config.source.path.string(),
                .charts = record.charts.charts(),
                .config_yaml = print_config(config)},
               summary);
  return summary;
}

void print_run_results(const json& summary, const RunTally& tally,
                       const std::filesystem::path& folder) {
  const json& frames = summary["frames"];
  const json& timing = summary["timing"];
  fmt::print("frames       {} read, {} used, {} rejected{}\n", frames["read"].dump(),
             frames["used"].dump(), frames["rejected"].dump(), reasons(summary["verdicts"]));
  fmt::print("speed        {}, estimator {} per frame (median)\n",
             figure(timing["frames_per_s"], "frames/s"),
             figure(timing["frame_ms"]["median"], "ms"));
  if (const json& commands = summary["commands"]; !commands.is_null()) {
    fmt::print("commands     {} issued, {} held (not executed by run)\n", commands["issued"].dump(),
               commands["held"].dump());
  }
  if (tally.last) print_final_position(*tally.last);
  if (const json& errors = summary["evaluation"]; !errors.is_null()) {
    fmt::print("against truth: {} stamps, path {}\n", errors["matched"].dump(),
               figure(errors["path_length_m"], "m"));
    if (errors["position_rmse_m"].is_number()) {
      fmt::print("  position   {} RMSE, drift {} of the path\n",
                 figure(errors["position_rmse_m"], "m"), figure(errors["drift_percent"], "%"));
    }
    if (errors["tilt_rmse_rad"].is_number()) {
      fmt::print("  attitude   {} tilt, {} yaw RMSE\n", figure(errors["tilt_rmse_rad"], "rad"),
                 figure(errors["yaw_rmse_rad"], "rad"));
    }
    if (const json& reference = errors["reference"]; reference["rotation_median_deg"].is_number()) {
      fmt::print("  from the reference: rotation {}, direction {} (median)\n",
                 figure(reference["rotation_median_deg"], "deg"),
                 figure(reference["direction_median_deg"], "deg"));
    }
  }
  fmt::print("report       {}\n", (folder / "report.html").string());
}

}  // namespace stillkite
