#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <thread>

#include "app/commands.hpp"
#include "app/hover_comparison.hpp"
#include "app/hover_device.hpp"
#include "app/hover_estimates.hpp"
#include "app/hover_report_trials.hpp"
#include "app/hover_results.hpp"
#include "app/hover_setup.hpp"
#include "app/interrupt.hpp"
#include "app/options.hpp"
#include "app/results_folder.hpp"
#include "app/trial_fleet.hpp"
#include "io/config/config_printing.hpp"
#include "io/results/json_text.hpp"
#include "io/results/output_file.hpp"
#include "io/results/part_file.hpp"
#include "simulation/hover/station_path.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

struct HoverArguments {
  std::optional<fs::path> config;
  std::vector<std::string> estimators;
  std::vector<std::string> overrides;
  fs::path out;
  fs::path serve;
  int jobs = 0;
  bool json = false;
};

constexpr std::uintmax_t kBytesPerTrial = 1 << 20;

int thread_count(int requested, std::size_t trials) {
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return std::min(requested > 0 ? requested : cores, static_cast<int>(trials));
}

// Throws InputError if a result would overwrite an input.
void prepare(const fs::path& folder, const fs::path& config_file, const HoverConfig& config,
             std::size_t trials) {
  std::vector<fs::path> inputs{config_file};
  if (config.plant_file) inputs.push_back(*config.plant_file);
  protect_inputs(folder,
                 {"trials.csv", "samples.csv", "estimates.csv", "hover.yaml", "summary.json",
                  "report.html", "comparison.json"},
                 inputs);
  prepare_output_folder(folder, trials * kBytesPerTrial);
}

std::vector<Trial> trials_of(const HoverConfig& config) {
  constexpr double kMaxDuration_s = 3600;
  if (config.plant.camera.readout_s > 0) {
    throw InputError("plant.camera.readout_s: trials simulate a global shutter only; set 0");
  }
  const std::vector<Trial> trials = make_trials(config);
  if (trials.empty()) {
    throw InputError("hover: trials.on and trials.off are both 0; set at least one");
  }
  for (const Trial& trial : trials) {
    const double duration_s = StationPath(config.plant.station, trial.axis).duration_s();
    if (duration_s <= kMaxDuration_s) continue;
    throw InputError(fmt::format(
        "plant.station: the path takes {:.3g} s, maximum {:.0f}; increase speed or acceleration",
        duration_s, kMaxDuration_s));
  }
  return trials;
}

struct FlownTrials {
  std::vector<TrialRecord> records;
  nlohmann::json summary;
};

// Flies the trials and writes the results.
FlownTrials fly_trials(const HoverArguments& arguments, const fs::path& out,
                       const HoverConfig& config, const HoverWorld& world,
                       const std::vector<Trial>& trials, const std::string& label) {
  const auto start = std::chrono::steady_clock::now();
  TrialFleet fleet(config, world, trials, label);
  const std::exception_ptr failure = fleet.fly(thread_count(arguments.jobs, trials.size()));
  const std::vector<TrialRecord>& records = fleet.records();
  if (failure && records.empty()) std::rethrow_exception(failure);
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const std::string policy(name_of(config.estimator.policy));
  nlohmann::json summary = hover_summary(records, policy, wall_s);
  summary["interrupted"] = interrupted();
  if (failure || interrupted()) {
    fmt::print(stderr, "stillkite: {}: stopped after {} of {} trials; their results are in {}\n",
               label, records.size(), trials.size(), out.string());
  }
  const std::vector<HoverReportTrial> drawn = hover_report_trials(records, fleet.images(), policy);
  const HoverReportContent report{
      .title = arguments.config->string(), .trials = drawn, .config_yaml = print_config(config)};
  const FolderLock lock(out);
  write_files(out, {{"trials.csv", trials_csv(records, policy)},
                    {"samples.csv", samples_csv(records)},
                    {"estimates.csv", hover_estimates_csv(records)},
                    {"hover.yaml", print_config(config)},
                    {"summary.json", json_text(summary) + '\n'},
                    {"report.html", hover_report_html(report, summary)}});
  if (failure) std::rethrow_exception(failure);
  return {.records = records, .summary = summary};
}

void hover_with_one(const HoverArguments& arguments) {
  const HoverConfig config = load_hover_config(arguments.config, arguments.overrides);
  const std::vector<Trial> trials = trials_of(config);
  const fs::path out = results_folder(arguments.out, *arguments.config);
  prepare(out, *arguments.config, config, trials.size());
  const FlownTrials flown = fly_trials(arguments, out, config, make_world(config), trials, "hover");
  if (arguments.json) {
    fmt::print("{}\n", json_text(flown.summary));
  } else {
    fmt::print("{}\n{} trials, {:.1f} x real time\nreport       {}\n", hover_table(flown.summary),
               flown.records.size(), flown.summary["timing"]["real_time_factor"].get<double>(),
               (out / "report.html").string());
  }
}

// Trials without stabilization do not depend on the estimator: only the first variant flies them,
// unless trials.estimate_off is set.
void hover_with_each(const HoverArguments& arguments) {
  const std::string list = fmt::format("{}", fmt::join(arguments.estimators, ","));
  const std::vector<HoverVariant> variants =
      load_hover_variants(*arguments.config, arguments.overrides, parse_variants(list));
  std::vector<Trial> trials = trials_of(variants.front().config);
  const fs::path out = results_folder(arguments.out, *arguments.config);
  prepare(out, *arguments.config, variants.front().config, 0);
  for (const HoverVariant& variant : variants) {
    prepare(out / variant.name, *arguments.config, variant.config, trials.size());
  }
  const HoverWorld world = make_world(variants.front().config);
  std::vector<ComparedTrials> compared;
  compared.reserve(variants.size());
  for (const HoverVariant& variant : variants) {
    if (interrupted()) break;
    FlownTrials flown = fly_trials(arguments, out / variant.name, variant.config, world, trials,
                                   "hover " + variant.name);
    compared.push_back({.name = variant.name,
                        .overrides = variant.overrides,
                        .estimator = variant.config.estimator,
                        .records = std::move(flown.records),
                        .summary = std::move(flown.summary)});
    if (!variant.config.trials.estimate_off) {
      std::erase_if(trials, [](const Trial& trial) { return !trial.stabilized; });
    }
    if (trials.empty()) break;
  }
  if (compared.empty()) throw Interrupted{};
  const nlohmann::json comparison = hover_comparison_json(compared);
  write_file(out / "comparison.json", json_text(comparison) + '\n');
  if (arguments.json) {
    fmt::print("{}\n", json_text(comparison));
  } else {
    fmt::print("{}results      {}\n", hover_comparison_table(comparison), out.string());
  }
}

// One trial in real time, flown by another program.
void serve(const HoverArguments& arguments) {
  const HoverConfig config = load_hover_config(arguments.config, arguments.overrides);
  const std::vector<Trial> trials = trials_of(config);
  const auto trial = std::ranges::find_if(trials, [&](const Trial& candidate) {
    return candidate.stabilized && candidate.axis == config.serve.axis;
  });
  if (trial == trials.end()) throw InputError("hover: --serve needs a trial; set trials.on to 1");
  prepare(arguments.serve, *arguments.config, config, 1);
  const TrialRecord record = serve_trial(config, make_world(config), *trial, arguments.serve);
  if (record.samples.empty() && interrupted()) throw Interrupted{};
  if (record.samples.empty()) throw std::runtime_error("hover: no command was received");
  const nlohmann::json summary = hover_summary(
      {&record, 1}, std::string(name_of(config.estimator.policy)), record.samples.back().t_s);
  write_files(arguments.serve, {{"samples.csv", samples_csv({&record, 1})},
                                {"hover.yaml", print_config(config)},
                                {"summary.json", json_text(summary) + '\n'}});
  if (arguments.json) {
    fmt::print("{}\n", json_text(summary));
  } else {
    const nlohmann::json& result = summary["trials"][0];
    fmt::print("axis {}: mean |d| {:.2f} cm, maximum {:.2f} cm in {:.1f} s\n",
               result["axis"].get<std::string>(), 100 * result["mean_m"].get<double>(),
               100 * result["max_m"].get<double>(), record.samples.back().t_s);
  }
}

void hover(const HoverArguments& arguments) {
  // one thread per trial scales better than OpenCV's threads within a trial
  cv::setNumThreads(1);
  if (!arguments.serve.empty()) {
    serve(arguments);
  } else if (arguments.estimators.empty()) {
    hover_with_one(arguments);
  } else {
    hover_with_each(arguments);
  }
  if (interrupted()) throw Interrupted{};
}

}  // namespace

void add_hover(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "hover", "Simulate the tethered drone in closed loop over a moving station (hold trials)");
  const auto arguments = std::make_shared<HoverArguments>();
  command->add_option("config", arguments->config, "YAML file, such as configs/trials_fused.yaml");
  command
      ->add_option(
          "--estimators", arguments->estimators,
          "Comma-separated policies and custom configurations NAME:key=value,key=value, each flown "
          "with the same seeds (default: the policy of the configuration)")
      ->allow_extra_args(false)
      ->type_name("LIST");
  add_overrides(*command, arguments->overrides);
  add_results_folder(*command, arguments->out);
  command
      ->add_option("--jobs", arguments->jobs, "Number of parallel trials (default: one per core)")
      ->check(CLI::Range(1, 1024));
  command
      ->add_option("--serve", arguments->serve,
                   "Simulate one trial in real time as a device for stillkite fly, which finds its "
                   "configuration in DIR/flight.yaml (keys serve.*)")
      ->type_name("DIR");
  command->add_flag("--json", arguments->json,
                    "Print only summary.json on stdout, with --estimators comparison.json");
  const auto print = std::make_shared<bool>(false);
  command->add_flag("--print", *print, "Print the configuration with descriptions and exit");
  command->footer(
      "Writes trials.csv (one row per trial), samples.csv (one row per image), estimates.csv\n"
      "(estimation errors), summary.json, report.html and the effective configuration hover.yaml.\n"
      "With --estimators: one such folder per estimator, and comparison.json. Trials without\n"
      "stabilization are then flown with the first estimator only, unless trials.estimate_off is "
      "set.");
  command->callback([arguments, print] {
    if (*print) {
      fmt::print("{}", print_config(load_hover_config(arguments->config, arguments->overrides)));
    } else if (!arguments->config) {
      throw InputError("hover: missing configuration; for example configs/trials_fused.yaml");
    } else {
      hover(*arguments);
    }
  });
}

}  // namespace stillkite
