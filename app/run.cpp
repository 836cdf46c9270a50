#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/interrupt.hpp"
#include "app/overlay_video.hpp"
#include "app/progress_bar.hpp"
#include "app/run_results.hpp"
#include "navigation/hover_pilot.hpp"

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

// What a frame's rows, and its part of the report, take on the disk at most.
constexpr std::uintmax_t kBytesPerFrame = 1700;
constexpr std::uintmax_t kBytesPerRun = 2 << 20;
constexpr std::uintmax_t kBytesPerDrawnFrame = 100'000;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// What is written while the frames come.
struct RunFiles {
  RunRecorder estimates;
  std::optional<CommandRecorder> commands;
  std::optional<OverlayVideo> overlay;

  void commit() {
    estimates.commit();
    if (commands) commands->commit();
    if (overlay) overlay->commit();
  }
};

RunFiles open_files(const std::filesystem::path& out, const RunConfig& config,
                    const FlightInputs& inputs) {
  RunFiles files{.estimates = RunRecorder(out), .commands = {}, .overlay = {}};
  if (config.has_shadow()) files.commands.emplace(out);
  if (config.output.overlay) {
    files.overlay.emplace(out / "overlay.mp4", inputs.camera, inputs.body_from_camera);
  }
  return files;
}

// Steps through the frames until the end or Ctrl-C. Gives the message of what ended it early, so
// that what was estimated is written first.
std::exception_ptr navigate(FrameSource& source, const FlightInputs& inputs,
                            const TetherState& tether, HoverPilot& pilot, RunFiles& files,
                            std::vector<float>& frame_ms) {
  try {
    ProgressBar progress("run", source.expected());
    std::optional<Timestamp> before;
    while (!interrupted()) {
      const std::optional<Frame> frame = source.next();
      if (!frame) break;
      const TetheredReadings readings{
          .now = frame->stamp,
          .tether = TetherReading{.stamp = frame->stamp, .tether = tether},
          .station_from_body = std::nullopt,
          .others = readings_between(inputs.sensors, before.value_or(frame->stamp), frame->stamp)};
      before = frame->stamp;
      const Clock::time_point start = Clock::now();
      const PilotStep step = pilot.step(*frame, readings);
      frame_ms.push_back(static_cast<float>(ms_since(start)));
      files.estimates.add(step.estimate);
      if (files.commands) files.commands->add(frame->stamp, step.decision);
      if (files.overlay) files.overlay->add(*frame, step.estimate, pilot.windows());
      progress.step();
    }
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

void run(const RunArguments& arguments) {
  const RunConfig config = load_run_config(arguments.config, arguments.overrides);
  FrameSource source(config.source);
  const FlightInputs inputs = read_flight_inputs(config, source.first());
  HoverPilot pilot(inputs.camera, inputs.body_from_camera, config.navigator, config.estimator,
                   in_the_shadow(config.hold), inputs.initial);

  const fs::path out =
      arguments.out.empty() ? fs::path("out") / arguments.config.stem() : arguments.out;
  const auto frames = static_cast<std::uintmax_t>(source.expected().value_or(0));
  const std::uintmax_t bytes_per_frame =
      kBytesPerFrame + (config.output.overlay ? kBytesPerDrawnFrame : 0);
  prepare_output_folder(out, kBytesPerRun + frames * bytes_per_frame);
  RunFiles files = open_files(out, config, inputs);
  if (inputs.initial.scale == ScaleSource::none) {
    fmt::print(stderr,
               "stillkite: no height is given: every metre below is one initial height over the "
               "ground (initial.height_m sets the scale)\n");
  }

  std::vector<float> frame_ms;
  const Clock::time_point start = Clock::now();
  const std::exception_ptr failure =
      navigate(source, inputs, config.shadow.tether.state(), pilot, files, frame_ms);
  const RunFacts facts{
      .frames_read = source.read(),
      .frame_ms = frame_ms,
      .wall_s = 1e-3 * ms_since(start),
      .interrupted = interrupted(),
      .complaint = source.complaint(),
      .commands = files.commands ? std::optional(files.commands->counts()) : std::nullopt};
  files.commit();
  if (facts.complaint) fmt::print(stderr, "stillkite: {}\n", *facts.complaint);
  if (failure || facts.interrupted) {
    fmt::print(stderr, "stillkite: stopped after {} frames; what was estimated is in {}\n",
               files.estimates.estimates().size(), out.string());
  }
  const nlohmann::json summary =
      write_run_results(out, config, inputs, files.estimates.estimates(), facts);
  if (failure) std::rethrow_exception(failure);
  if (arguments.json) {
    fmt::print("{}\n", summary.dump(2));
  } else {
    print_run_results(summary, out);
  }
  if (facts.interrupted) throw Interrupted{};
}

}  // namespace

void add_run(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("run", "Estimate the motion from a video or a data set of pictures");
  const auto arguments = std::make_shared<RunArguments>();
  command->add_option("config", arguments->config, "YAML file; see: stillkite config")->required();
  command
      ->add_option("--set", arguments->overrides,
                   "Override a key of the configuration, as key=value; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command->add_option("--out", arguments->out, "Folder for the results (default: out/CONFIG)")
      ->type_name("DIR");
  command->add_flag("--json", arguments->json, "Print summary.json on stdout and nothing else");
  command->footer(
      "Writes estimates.csv (one row a frame), trajectory.tum, summary.json and report.html;\n"
      "with --set output.overlay=true overlay.mp4 too; with --set estimator.policy=reference\n"
      "commands.csv, what the controller would command.\n"
      "Example: stillkite run flight.yaml --set source.path=flight.mp4 --out results");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace stillkite
