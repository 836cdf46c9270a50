#include <fmt/chrono.h>
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <ctime>
#include <memory>

#include "app/commands.hpp"
#include "app/interrupt.hpp"
#include "app/live_flight.hpp"
#include "app/options.hpp"
#include "app/results_folder.hpp"
#include "io/config/config_printing.hpp"
#include "io/text_file.hpp"
#include "live/stream/stream_address.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

struct FlyArguments {
  std::optional<fs::path> config;
  std::vector<std::string> overrides;
  fs::path out;
  bool print = false;
};

fs::path flight_folder(const FlyArguments& arguments) {
  if (!arguments.out.empty()) return arguments.out;
  const std::string name = arguments.config ? flight_name(*arguments.config) : "flight";
  return fs::path("out") /
         fmt::format("{}-{:%Y%m%d-%H%M%S}", name, fmt::gmtime(std::time(nullptr)));
}

// Throws InputError before anything is opened or written.
StreamConfig expanded(StreamConfig source) {
  source.path = expand_environment(source.path, "source.path");
  static_cast<void>(parse_stream_address(source.path));
  return source;
}

void fly(const FlyArguments& arguments) {
  const FlyConfig config = load_fly_config(arguments.config, arguments.overrides);
  if (arguments.print) {
    fmt::print("{}", print_config(config));
    return;
  }
  std::signal(SIGPIPE, SIG_IGN);  // write() then returns an error without a reader
  const StreamConfig source = expanded(config.source);
  const fs::path folder = flight_folder(arguments);
  bool has_estimates = false;
  {
    const auto flight = std::make_unique<LiveFlight>(config, source, folder);
    flight->run();
    flight->report_counts();
    has_estimates = flight->has_estimates();
    if (!interrupted() && !flight->has_images()) {
      throw InputError(
          "source.path: standard input has no video; expected MPEG-TS, MJPEG or H.264");
    }
  }
  if (has_estimates) {
    fmt::print(stderr, "stillkite: record: {0}; its estimates again: stillkite run {0}\n",
               folder.string());
  }
  if (interrupted()) throw Interrupted{};
}

}  // namespace

void add_fly(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "fly",
      "Estimate the motion from a live video; telemetry, MAVLink output, tethered position hold, "
      "operator's page");
  const auto arguments = std::make_shared<FlyArguments>();
  command->add_option("config", arguments->config, "YAML file (default: default values)");
  add_overrides(*command, arguments->overrides);
  command
      ->add_option("--out", arguments->out, "New folder for the record (default: out/CONFIG-TIME)")
      ->type_name("DIR");
  command->add_flag("--print", arguments->print,
                    "Print the configuration with descriptions and exit");
  command->footer(
      "Keys with default and description: stillkite fly --print > flight.yaml\n"
      "Records video, telemetry, estimates and commands; stillkite run DIR computes them again.\n"
      "Example: stillkite fly flight.yaml --set source.path=udp://127.0.0.1:5600 --set "
      "live.json=-\n"
      "Operator's page: --set live.listen=127.0.0.1:8080, then http://127.0.0.1:8080 in a browser");
  command->callback([arguments] { fly(*arguments); });
}

}  // namespace stillkite
