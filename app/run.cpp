#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.hpp"
#include "app/estimator_run.hpp"
#include "app/interrupt.hpp"
#include "app/options.hpp"
#include "app/recorded_flight.hpp"
#include "app/replay_flight.hpp"
#include "app/results_folder.hpp"
#include "app/run_results.hpp"
#include "app/run_warnings.hpp"
#include "io/results/json_text.hpp"
#include "io/results/part_file.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct RunArguments {
  fs::path config;
  std::vector<std::string> overrides;
  fs::path out;
  bool json = false;
};

void run(const RunArguments& arguments) {
  if (is_flight_record(arguments.config)) {
    return replay_flight({.record = arguments.config,
                          .overrides = arguments.overrides,
                          .out = arguments.out,
                          .json = arguments.json});
  }
  const RunConfig config = load_run_config(arguments.config, arguments.overrides);
  FrameSource source(config.source);
  check_row_times(source, config);
  EstimatorRun estimator(config, source.first());

  const fs::path out = results_folder(arguments.out, arguments.config);
  protect_inputs_of_run(out, arguments.config, config);
  estimator.write_to(out, source.expected());
  report_input_warnings(std::span(&estimator, 1));

  const Clock::time_point start = Clock::now();
  RunOutcome outcome = step_through(source, std::span(&estimator, 1), "run");
  const double wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  const FolderLock lock(out);
  finish_files(std::span(&estimator, 1), outcome);
  const RunFacts facts{.frames_read = source.read(),
                       .frame_ms = estimator.frame_ms(),
                       .wall_s = wall_s,
                       .interrupted = interrupted(),
                       .problem = outcome.problem,
                       .commands = estimator.commands()};
  remove_earlier_results(out, inputs_of_run(arguments.config, config));
  estimator.commit();
  report_outcome(outcome, std::span(&estimator, 1), out);
  report_inconsistencies(estimator);
  const nlohmann::json summary =
      write_run_results(out, estimator.config(), estimator.inputs(), estimator.record(), facts);
  if (outcome.failure) std::rethrow_exception(outcome.failure);
  if (arguments.json) {
    fmt::print("{}\n", json_text(summary));
  } else {
    print_run_results(summary, estimator.record().tally, out);
  }
  if (facts.interrupted) throw Interrupted{};
}

}  // namespace

void add_run(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("run", "Estimate the motion from a video or an image data set");
  const auto arguments = std::make_shared<RunArguments>();
  command
      ->add_option("config", arguments->config,
                   "YAML file, see: stillkite config; or a flight recorded by stillkite fly")
      ->required();
  add_overrides(*command, arguments->overrides);
  add_results_folder(*command, arguments->out);
  command->add_flag("--json", arguments->json, "Print only summary.json on stdout");
  command->footer(
      "Writes estimates.csv (one row per frame), trajectory.tum, summary.json and report.html;\n"
      "with --set output.overlay=true also overlay.mp4; with --set estimator.policy=reference,\n"
      "best or fused also commands.csv, the commands of the controller in shadow mode.\n"
      "Example: stillkite run flight.yaml --set source.path=flight.mp4 --out results");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace stillkite
