#include "app/replay_flight.hpp"

#include <fmt/core.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "app/interrupt.hpp"
#include "app/progress_bar.hpp"
#include "app/recorded_flight.hpp"
#include "app/results_folder.hpp"
#include "app/run_record.hpp"
#include "app/run_results.hpp"
#include "io/results/command_recorder.hpp"
#include "io/results/json_text.hpp"
#include "io/results/output_file.hpp"
#include "io/results/run_recorder.hpp"

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

RunConfig effective_run_config(const FlightEstimator& estimator) {
  RunConfig config = run_config_of(estimator.config());
  config.navigator = estimator.config().navigator;
  return config;
}

}  // namespace

void replay_flight(const ReplayArguments& arguments) {
  RecordedFlight flight(arguments.record, arguments.overrides);
  const FlightEstimator& estimator = flight.estimator();
  const fs::path out = folder_for(arguments);
  protect_inputs(out, {kEstimatesFile, kCommandsFile},
                 {arguments.record / kEstimatesFile, arguments.record / kCommandsFile});
  prepare_output_folder(out, 0);
  RunRecorder recorder(out);
  std::optional<CommandRecorder> commands;
  if (estimator.has_tether()) commands.emplace(out);
  std::optional<RunRecord> record;
  std::vector<float> frame_ms;
  const Clock::time_point start = Clock::now();
  {
    ProgressBar progress("run", flight.frames());
    while (!interrupted()) {
      const std::optional<RecordedStep> step = flight.next();
      if (!step) break;
      frame_ms.push_back(step->step_ms);
      const NavigationEstimate& estimate = step->result.estimate;
      if (!record) record.emplace(estimator.inputs());
      record->add(estimate, estimator.inputs());
      recorder.add(estimate);
      if (commands) commands->add(estimate.stamp, step->result.decision);
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
