#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "app/commands.hpp"
#include "app/options.hpp"
#include "io/config/config_printing.hpp"
#include "io/config/run_config.hpp"
#include "navigation/effective_config.hpp"

namespace stillkite {
namespace {

struct ConfigArguments {
  std::optional<std::filesystem::path> config;
  std::vector<std::string> overrides;
};

// Reads no inputs: assumes that a range finder has a reading at the first frame.
ScaleSource initial_scale(const RunConfig& config) {
  const bool has_height = config.initial.from_truth || config.initial.height_m ||
                          config.height.source == HeightSource::range;
  return has_height ? ScaleSource::initial_height : ScaleSource::none;
}

}  // namespace

void add_config(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "config", "Print the configuration of a run: every key with value, range and description");
  const auto arguments = std::make_shared<ConfigArguments>();
  command->add_option("config", arguments->config, "YAML file (default: default values)");
  add_overrides(*command, arguments->overrides);
  command->footer("The output is a valid configuration: stillkite config > my.yaml");
  command->callback([arguments] {
    RunConfig config = load_run_config(arguments->config, arguments->overrides);
    config.navigator =
        effective_config(config.navigator, config.estimator.policy, initial_scale(config));
    fmt::print("{}", print_config(config));
  });
}

}  // namespace stillkite
