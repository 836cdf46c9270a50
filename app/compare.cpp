#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <opencv2/core/utility.hpp>

#include "app/commands.hpp"
#include "app/comparison_results.hpp"
#include "app/estimator_run.hpp"
#include "app/interrupt.hpp"
#include "app/options.hpp"
#include "app/results_folder.hpp"
#include "app/run_evaluation.hpp"
#include "app/run_results.hpp"
#include "app/run_warnings.hpp"
#include "app/variants.hpp"
#include "io/config/config_printing.hpp"
#include "io/report/comparison_report.hpp"
#include "io/results/json_text.hpp"
#include "io/results/output_file.hpp"
#include "io/results/part_file.hpp"

namespace stillkite {
namespace {

struct CompareArguments {
  std::filesystem::path config;
  std::vector<std::string> estimators;
  std::vector<std::string> overrides;
  std::filesystem::path out;
  int threads = 1;
  bool json = false;
};

std::vector<EstimatorRun> make_runs(const std::vector<Variant>& variants,
                                    const FrameSource& source) {
  std::vector<EstimatorRun> runs;
  runs.reserve(variants.size());
  for (const Variant& variant : variants) {
    try {
      check_row_times(source, variant.config);
      runs.emplace_back(variant.config, source.first());
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", variant.name, error.what()));
    }
  }
  return runs;
}

// Replaces the results of an earlier call.
void commit_runs(const std::filesystem::path& out, const CompareArguments& arguments,
                 const std::vector<Variant>& variants, std::span<EstimatorRun> runs) {
  std::vector<std::filesystem::path> inputs;
  for (const Variant& variant : variants) {
    std::ranges::copy(inputs_of_run(arguments.config, variant.config), std::back_inserter(inputs));
  }
  remove_earlier_results(out, inputs);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    remove_earlier_results(out / variants[i].name, inputs);
    runs[i].commit();
  }
}

ComparedRun write_run(const std::filesystem::path& folder, const Variant& variant,
                      const EstimatorRun& run, RunFacts facts) {
  const std::span<const float> frame_ms = run.frame_ms();
  facts.frame_ms = frame_ms;
  facts.wall_s = 1e-3 * std::accumulate(frame_ms.begin(), frame_ms.end(), 0.0);
  facts.commands = run.commands();
  return {.name = variant.name,
          .overrides = variant.overrides,
          .estimator = variant.config.estimator,
          .summary = write_run_results(folder, run.config(), run.inputs(), run.record(), facts),
          .errors = run_frame_errors(run.inputs(), run.record().motions),
          .estimator_s = facts.wall_s};
}

void write_page(const std::filesystem::path& file, const CompareArguments& arguments,
                const std::vector<Variant>& variants, const std::vector<EstimatorRun>& runs,
                const nlohmann::json& comparison) {
  std::vector<ComparedCharts> charts;
  charts.reserve(runs.size());
  std::string configs;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    charts.push_back({.name = variants[i].name,
                      .charts = runs[i].record().charts.charts(),
                      .frame_ms = runs[i].frame_ms()});
    configs += fmt::format("# {}\n{}\n", variants[i].name, print_config(runs[i].config()));
  }
  write_comparison_report(
      file, {.title = arguments.config.string(), .runs = std::move(charts), .config_yaml = configs},
      comparison);
}

void compare(const CompareArguments& arguments) {
  const auto list = arguments.estimators.empty()
                        ? std::nullopt
                        : std::optional(fmt::format("{}", fmt::join(arguments.estimators, ",")));
  const std::vector<Variant> variants =
      load_variants(arguments.config, arguments.overrides, parse_variants(list));
  cv::setNumThreads(arguments.threads);
  FrameSource source(variants.front().config.source);
  std::vector<EstimatorRun> runs = make_runs(variants, source);
  const std::filesystem::path out = results_folder(arguments.out, arguments.config);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    protect_inputs_of_run(out, arguments.config, variants[i].config);
    protect_inputs_of_run(out / variants[i].name, arguments.config, variants[i].config);
    runs[i].write_to(out / variants[i].name, source.expected());
  }
  report_input_warnings(runs);

  const auto start = std::chrono::steady_clock::now();
  RunOutcome outcome = step_through(source, runs, "compare");
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const FolderLock lock(out);
  finish_files(runs, outcome);
  const ComparisonFacts facts{.frames_read = source.read(),
                              .wall_s = wall_s,
                              .decoding_s = source.decoding_s(),
                              .threads = arguments.threads,
                              .interrupted = interrupted(),
                              .problem = outcome.problem};
  report_outcome(outcome, runs, out);
  commit_runs(out, arguments, variants, runs);
  for (const EstimatorRun& run : runs) report_inconsistencies(run);
  std::vector<ComparedRun> compared;
  compared.reserve(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const RunFacts run_facts{.frames_read = facts.frames_read,
                             .frame_ms = {},
                             .interrupted = facts.interrupted,
                             .problem = facts.problem,
                             .commands = {}};
    compared.push_back(write_run(out / variants[i].name, variants[i], runs[i], run_facts));
  }
  const nlohmann::json comparison = comparison_json(compared, facts);
  write_file(out / "comparison.json", json_text(comparison) + '\n');
  write_page(out / "report.html", arguments, variants, runs, comparison);
  if (outcome.failure) std::rethrow_exception(outcome.failure);
  if (arguments.json) {
    fmt::print("{}\n", json_text(comparison));
  } else {
    fmt::print("{}report       {}\n", comparison_table(comparison), (out / "report.html").string());
  }
  if (facts.interrupted) throw Interrupted{};
}

}  // namespace

void add_compare(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("compare", "Compare several estimators on the same frames");
  const auto arguments = std::make_shared<CompareArguments>();
  command->add_option("config", arguments->config, "YAML file; see: stillkite config")->required();
  command
      ->add_option("--estimators", arguments->estimators,
                   "Comma-separated policies and custom configurations "
                   "NAME:key=value,key=value (default: all policies)")
      ->allow_extra_args(false)
      ->type_name("LIST");
  add_overrides(*command, arguments->overrides);
  add_results_folder(*command, arguments->out);
  command
      ->add_option(
          "--threads", arguments->threads,
          "Threads per estimator; compare times only with one, the default. Decoding runs on "
          "separate threads")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--json", arguments->json, "Print only comparison.json on stdout");
  command->footer(
      "Writes comparison.json, report.html, and one folder per estimator with the outputs of run.\n"
      "Example: stillkite compare flight.yaml "
      "--estimators flow,reference,paper:estimator.policy=flow,estimator.mode=paper");
  command->callback([arguments] { compare(*arguments); });
}

}  // namespace stillkite
