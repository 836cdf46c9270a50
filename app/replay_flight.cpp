#include "app/replay_flight.hpp"

#include <fmt/core.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/flight_estimator.hpp"
#include "app/fly_config.hpp"
#include "app/interrupt.hpp"
#include "app/progress_bar.hpp"
#include "app/results_folder.hpp"
#include "app/run_record.hpp"
#include "app/run_results.hpp"
#include "io/results/command_recorder.hpp"
#include "io/results/json_text.hpp"
#include "io/results/output_file.hpp"
#include "io/results/run_recorder.hpp"
#include "io/video/luma.hpp"
#include "live/mavlink/parser.hpp"
#include "live/operator/operator_command.hpp"
#include "live/record/flight_replay.hpp"
#include "live/tether/station_lines.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

fs::path folder_for(const ReplayArguments& arguments) {
  if (!arguments.out.empty()) return arguments.out;
  return fs::path("out") / ("run-" + fs::absolute(arguments.record / kFlightConfig)
                                         .lexically_normal()
                                         .parent_path()
                                         .filename()
                                         .string());
}

void receive(FlightEstimator& estimator, mavlink::Parser& parser,
             const std::vector<RecordedMessage>& messages) {
  for (const RecordedMessage& message : messages) {
    const std::string text(message.bytes.begin(), message.bytes.end());
    switch (message.source) {
      case MessageSource::mavlink:
        parser.add(message.bytes);
        while (const auto packet = parser.next()) estimator.receive(*packet, message.arrival);
        break;
      case MessageSource::station:
        if (const auto line = parse_station_line(text)) estimator.receive(*line, message.arrival);
        break;
      case MessageSource::sensors:
        if (const auto parsed = parse_sensor_line(text); parsed.line) {
          estimator.receive(*parsed.line, message.arrival);
        }
        break;
      case MessageSource::operator_command:
        if (const auto command = parse_operator_command(text, message.arrival)) {
          static_cast<void>(estimator.receive(*command));  // refused as in flight
        }
        break;
    }
  }
}

RunConfig effective_run_config(const FlightEstimator& estimator) {
  RunConfig config = run_config_of(estimator.config());
  config.navigator = estimator.config().navigator;
  return config;
}

}  // namespace

bool is_flight_record(const fs::path& path) {
  return fs::is_directory(path) && fs::exists(path / kFlightConfig);
}

void replay_flight(const ReplayArguments& arguments) {
  FlightEstimator estimator(load_fly_config(arguments.record / kFlightConfig, arguments.overrides));
  LumaExtractor luma("source.path", std::nullopt);
  FlightReplay replay(arguments.record, [&](const AVFrame& image, cv::Mat recycled) {
    return luma.extract(image, std::move(recycled));
  });
  const fs::path out = folder_for(arguments);
  protect_inputs(out, {kEstimatesFile, kCommandsFile},
                 {arguments.record / kEstimatesFile, arguments.record / kCommandsFile});
  prepare_output_folder(out, 0);
  RunRecorder recorder(out);
  std::optional<CommandRecorder> commands;
  if (estimator.has_tether()) commands.emplace(out);
  std::optional<RunRecord> record;
  mavlink::Parser parser;
  std::vector<float> frame_ms;
  const Clock::time_point start = Clock::now();
  {
    ProgressBar progress("run", replay.frames());
    while (!interrupted()) {
      const std::optional<ReplayedFrame> replayed = replay.next();
      if (!replayed) break;
      receive(estimator, parser, replayed->telemetry);
      const Clock::time_point frame_start = Clock::now();
      const PilotStep step = estimator.step(replayed->frame, replayed->decision);
      const NavigationEstimate& estimate = step.estimate;
      frame_ms.push_back(
          std::chrono::duration<float, std::milli>(Clock::now() - frame_start).count());
      if (!record) record.emplace(estimator.inputs());
      record->add(estimate, estimator.inputs());
      recorder.add(estimate);
      if (commands) commands->add(estimate.stamp, step.decision);
      progress.step();
    }
  }
  if (!record) throw InputError(arguments.record.string() + ": the record has no used frame");
  recorder.finish();
  recorder.commit();
  if (commands) {
    commands->finish();
    commands->commit();
  }
  const RunFacts facts{.frames_read = static_cast<std::int64_t>(frame_ms.size()),
                       .frame_ms = frame_ms,
                       .wall_s = std::chrono::duration<double>(Clock::now() - start).count(),
                       .interrupted = interrupted(),
                       .problem = std::nullopt,
                       .commands = commands ? std::optional(commands->counts()) : std::nullopt};
  const nlohmann::json summary =
      write_run_results(out, effective_run_config(estimator), estimator.inputs(), *record, facts);
  if (arguments.json) {
    fmt::print("{}\n", json_text(summary));
  } else {
    print_run_results(summary, record->tally, out);
  }
  if (facts.interrupted) throw Interrupted{};
}

}  // namespace stillkite
