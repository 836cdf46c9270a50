#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/commands.hpp"
#include "app/options.hpp"
#include "app/setup_examination.hpp"
#include "io/results/json_text.hpp"

namespace stillkite {
namespace {

struct CheckArguments {
  std::filesystem::path config;
  std::vector<std::string> overrides;
  bool json = false;
};

nlohmann::json json_of(const SetupFinding& finding) {
  const auto number = [](const std::optional<double>& value) {
    return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json();
  };
  nlohmann::json out{
      {"question", finding.question},
      {"verdict", name_of(finding.verdict)},
      {"text", finding.text},
      {"remedy", finding.remedy.empty() ? nlohmann::json() : nlohmann::json(finding.remedy)},
      {"measured", nullptr}};
  if (finding.measured) {
    out["measured"] = {{"value", number(finding.measured->value)},
                       {"sigma", number(finding.measured->sigma)},
                       {"bound", number(finding.measured->bound)},
                       {"unit", finding.measured->unit}};
  }
  return out;
}

nlohmann::json json_of(const SetupReport& report) {
  nlohmann::json findings = nlohmann::json::array();
  for (const SetupFinding& finding : report.findings) findings.push_back(json_of(finding));
  return {{"verdict", name_of(worst_verdict(report.findings))},
          {"frames", report.frames},
          {"duration_s", report.duration_s},
          {"findings", std::move(findings)}};
}

void print(const SetupReport& report) {
  std::size_t width = 0;
  for (const SetupFinding& finding : report.findings) {
    width = std::max(width, finding.question.size());
  }
  for (const SetupFinding& finding : report.findings) {
    fmt::print("{:<11}  {:<{}}  {}\n", name_of(finding.verdict), finding.question, width,
               finding.text);
    if (!finding.remedy.empty())
      fmt::print("{:<11}  {:<{}}  -> {}\n", "", "", width, finding.remedy);
  }
  const auto unanswered =
      std::ranges::count(report.findings, SetupVerdict::cannot_tell, &SetupFinding::verdict);
  fmt::print("{}: {} images, {:.1f} s examined; {} of {} questions cannot be answered\n",
             name_of(worst_verdict(report.findings)), report.frames, report.duration_s, unanswered,
             report.findings.size());
}

void check(const CheckArguments& arguments) {
  const SetupReport report = examine_setup(load_run_config(arguments.config, arguments.overrides));
  if (arguments.json) {
    fmt::print("{}\n", json_text(json_of(report)));
  } else {
    print(report);
  }
  switch (worst_verdict(report.findings)) {
    case SetupVerdict::wrong:
      throw CheckFailed{.is_wrong = true};
    case SetupVerdict::doubtful:
      throw CheckFailed{.is_wrong = false};
    default:
      return;
  }
}

}  // namespace

void add_check(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "check", "Examine the set-up of a flight: camera, sensors, axes, units, clocks, scene");
  const auto arguments = std::make_shared<CheckArguments>();
  command->add_option("config", arguments->config, "YAML file, as for stillkite run")->required();
  add_overrides(*command, arguments->overrides);
  command->add_flag("--json", arguments->json, "Print the findings as JSON");
  command->footer(
      "Prints one line per question: verdict (ok, doubtful, wrong, cannot tell), measured value "
      "with\n"
      "its bound, and the line of the configuration that corrects it. Examines 30 s from\n"
      "source.start_s, at most 900 images. Writes no files.\n"
      "Exit status: 0 nothing doubtful, 1 doubtful, 2 wrong (also wrong use), 130 interrupted.\n"
      "Example: stillkite check flight.yaml --set source.start_s=20");
  command->callback([arguments] { check(*arguments); });
}

}  // namespace stillkite
