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
    // the scale is known to a run only: it may depend on the first reading of a range finder
    config.navigator =
        effective_config(config.navigator, config.estimator.policy, ScaleSource::initial_height);
    fmt::print("{}", print_config(config));
  });
}

}  // namespace stillkite
