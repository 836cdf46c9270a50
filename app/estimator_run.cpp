#include "app/estimator_run.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cmath>

#include "app/interrupt.hpp"
#include "app/progress_bar.hpp"
#include "io/dataset/flight_sensors.hpp"
#include "io/results/output_file.hpp"
#include "navigation/effective_config.hpp"
#include "navigation/pilot_step.hpp"

namespace stillkite {
namespace {

using RunClock = std::chrono::steady_clock;

// Upper bounds of the disk space of results.
constexpr std::uintmax_t kBytesPerFrame = 1700;
constexpr std::uintmax_t kBytesPerRun = 2 << 20;
constexpr std::uintmax_t kBytesPerOverlayFrame = 100'000;

RunConfig effective_run_config(RunConfig config, const InitialState& initial) {
  config.navigator = effective_config(config.navigator, config.estimator.policy, initial.scale);
  return config;
}

void check_solver(const RunConfig& config, const FlightInputs& inputs) {
  const bool needs_imu = config.estimator.policy == Policy::fused &&
                         config.navigator.fusion.solver == FusionSolver::window;
  if (!needs_imu || !inputs.sensors.imu.stamps.empty()) return;
  throw InputError(
      "fusion.solver: window needs an IMU; set imu.path to its log, or fusion.solver to filter");
}

HoverPilot make_pilot(const RunConfig& config, const FlightInputs& inputs) {
  check_solver(config, inputs);
  NavigatorConfig navigator = config.navigator;
  navigator.fusion = with_imu_noise(navigator.fusion, inputs.sensors.imu_noise);
  navigator.sensors.gyro_sigma_rad_s =
      std::hypot(navigator.sensors.gyro_sigma_rad_s, inputs.sensors.rate_sigma_rad_s);
  return {inputs.camera,    inputs.body_from_camera,     navigator,
          config.estimator, in_shadow_mode(config.hold), inputs.initial};
}

}  // namespace

EstimatorRun::EstimatorRun(RunConfig config, const Frame& first)
    : inputs_(read_flight_inputs(config, first)),
      config_(effective_run_config(std::move(config), inputs_.initial)),
      pilot_(make_pilot(config_, inputs_)),
      record_(inputs_) {}

void EstimatorRun::write_to(const std::filesystem::path& folder,
                            std::optional<std::int64_t> expected_frames) {
  const auto frames = static_cast<std::uintmax_t>(expected_frames.value_or(0));
  const std::uintmax_t bytes_per_frame =
      kBytesPerFrame + (config_.output.overlay ? kBytesPerOverlayFrame : 0);
  prepare_output_folder(folder, kBytesPerRun + frames * bytes_per_frame);
  files_.emplace(Files{.estimates = RunRecorder(folder), .commands = {}, .overlay = {}});
  if (config_.has_shadow()) files_->commands.emplace(folder);
  if (config_.output.overlay) {
    files_->overlay.emplace(folder / "overlay.mp4", inputs_.camera, inputs_.body_from_camera);
  }
}

void EstimatorRun::step(const Frame& frame) {
  const TetheredReadings readings{
      .now = frame.stamp,
      .tether = TetherReading{.stamp = frame.stamp, .tether = config_.shadow.tether.state()},
      .station_from_body = std::nullopt,
      .sensors =
          readings_between(inputs_.sensors, previous_stamp_.value_or(frame.stamp), frame.stamp)};
  previous_stamp_ = frame.stamp;
  const RunClock::time_point start = RunClock::now();
  Frame masked = frame;
  masked.mask = inputs_.mask;
  PilotStep step = pilot_.step(masked, readings);
  frame_ms_.push_back(std::chrono::duration<float, std::milli>(RunClock::now() - start).count());
  gravity_alignment_ = step.estimate.gravity_alignment;
  if (!starts_from_true_attitude()) step.estimate = gravity_aligned(std::move(step.estimate));
  record_.add(step.estimate, inputs_);
  files_->estimates.add(step.estimate);
  if (files_->commands) files_->commands->add(frame.stamp, step.decision);
  if (files_->overlay) files_->overlay->add(frame, step.estimate, pilot_.flow_vectors());
}

void EstimatorRun::finish() {
  files_->estimates.finish();
  if (files_->commands) files_->commands->finish();
  if (files_->overlay) files_->overlay->finish();
}

void EstimatorRun::commit() {
  files_->estimates.commit();
  if (files_->commands) files_->commands->commit();
  if (files_->overlay) files_->overlay->commit();
}

std::optional<CommandCounts> EstimatorRun::commands() const {
  return files_->commands ? std::optional(files_->commands->counts()) : std::nullopt;
}

RunOutcome step_through(FrameSource& source, std::span<EstimatorRun> runs,
                        const std::string& label) {
  try {
    ProgressBar progress(label, source.expected());
    std::size_t first = 0;
    while (!interrupted()) {
      const std::optional<Frame> frame = source.next();
      if (!frame) break;
      for (std::size_t i = 0; i < runs.size(); ++i) runs[(first + i) % runs.size()].step(*frame);
      ++first;
      progress.step();
    }
  } catch (const std::exception& error) {
    return {.failure = std::current_exception(), .problem = error.what()};
  }
  return {.failure = nullptr, .problem = source.problem()};
}

void finish_files(std::span<EstimatorRun> runs, RunOutcome& outcome) {
  for (EstimatorRun& run : runs) {
    try {
      run.finish();
    } catch (const std::exception& error) {
      if (outcome.failure) continue;
      outcome = {.failure = std::current_exception(), .problem = error.what()};
    }
  }
}

void check_row_times(const FrameSource& source, const RunConfig& config) {
  if (!source.is_rotated() || config.navigator.readout_s == 0) return;
  throw InputError(
      fmt::format("navigator.readout_s: {} has a rotation tag, so image rows are not sensor rows; "
                  "remove the tag and calibrate the images as stored, or set "
                  "navigator.readout_s to 0",
                  config.source.path.string()));
}

}  // namespace stillkite
