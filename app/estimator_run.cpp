#include "app/estimator_run.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "app/interrupt.hpp"
#include "app/progress_bar.hpp"
#include "app/run_evaluation.hpp"
#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "io/dataset/gyro_check.hpp"
#include "io/dataset/sensor_checks.hpp"
#include "io/results/output_file.hpp"

namespace stillkite {
namespace {

using RunClock = std::chrono::steady_clock;

// What a frame's rows, and its part of the report, take on the disk at most.
constexpr std::uintmax_t kBytesPerFrame = 1700;
constexpr std::uintmax_t kBytesPerRun = 2 << 20;
constexpr std::uintmax_t kBytesPerDrawnFrame = 100'000;

HoverPilot make_pilot(const RunConfig& config, const FlightInputs& inputs) {
  return {inputs.camera,    inputs.body_from_camera,    config.navigator,
          config.estimator, in_the_shadow(config.hold), inputs.initial};
}

using Sentences = std::vector<std::string>;

// One for each sensor's log, and for a truth, that says nothing of much of the flight.
Sentences uncovered_sensors(const EstimatorRun& run) {
  if (run.estimates().empty()) return {};
  const Timestamp first = run.estimates().front().stamp, last = run.estimates().back().stamp;
  Sentences found = uncovered_by_sensors(run.inputs().sensors, first, last);
  const std::vector<StampedPose>& truth = run.inputs().truth;
  if (truth.empty()) return found;
  const std::int64_t judged = frames_with_truth(run.inputs(), run.estimates());
  if (judged >= kFewestToJudge) return found;
  found.push_back(fmt::format(
      "truth: it has a pose at {} of the images, too few to judge by: it is from {:.3f} s to "
      "{:.3f} s, the images are from {:.3f} s to {:.3f} s: are both on one clock?",
      judged, to_seconds(truth.front().stamp), to_seconds(truth.back().stamp), to_seconds(first),
      to_seconds(last)));
  return found;
}

std::optional<std::string> missing_scale(const FlightInputs& inputs) {
  if (inputs.initial.scale != ScaleSource::none) return std::nullopt;
  return fmt::format(
      "no height is given: every metre below is one initial height over the ground "
      "(initial.height_m sets the scale){}",
      inputs.sensors.imu.stamps.empty()
          ? ""
          : "; with estimator.policy=fused a metre from where the column scale says imu");
}

std::optional<std::string> sky(const FlightInputs& inputs) {
  const Camera& camera = inputs.camera;
  const Eigen::Vector3d up =
      (inputs.initial.world_from_body.rotation * inputs.body_from_camera.rotation).conjugate() *
      Eigen::Vector3d::UnitZ();
  for (const double x : {0, camera.width_px - 1}) {
    for (const double y : {0, camera.height_px - 1}) {
      const auto point = undistort(camera, {x, y});
      if (!point || point->homogeneous().dot(up) < 0) return std::nullopt;
    }
  }
  return fmt::format(
      "no ground is in view at the start: by mount and attitude the camera looks {:.0f} deg above "
      "the horizon (mount.down_deg or the calibration's mount, initial.roll_deg, "
      "initial.pitch_deg)",
      std::atan2(up.z(), up.head<2>().norm()) / kDegree);
}

Sentences doubtful_inputs(const EstimatorRun& run) {
  Sentences found;
  if (const auto sentence = missing_scale(run.inputs())) found.push_back(*sentence);
  if (const auto sentence = sky(run.inputs())) found.push_back(*sentence);
  if (const std::size_t left_out = run.inputs().sensors.imu_left_out; left_out > 0) {
    found.push_back(fmt::format(
        "imu.path: left out: {} of {} readings, zeros alone or a leap away from both neighbours",
        left_out, left_out + run.inputs().sensors.imu.stamps.size()));
  }
  if (run.config().acceleration.path && run.config().estimator.mode_in_use() != Mode::paper) {
    found.emplace_back("acceleration.path: only estimator.mode=paper uses it");
  }
  if (run.inputs().mask && run.config().estimator.mode_in_use() == Mode::paper &&
      run.config().estimator.policy != Policy::reference) {
    found.emplace_back("calibration.mask_path: the flow of estimator.mode=paper does not use it");
  }
  return found;
}

// What several estimators have in common is told once.
void tell(std::span<const EstimatorRun> runs, Sentences (*sentences_of)(const EstimatorRun&)) {
  std::set<std::string> told;
  for (const EstimatorRun& run : runs) {
    for (const std::string& sentence : sentences_of(run)) {
      if (told.insert(sentence).second) fmt::print(stderr, "stillkite: {}\n", sentence);
    }
  }
}

// Legs, text and the like that no mask had hidden before.
Sentences what_is_fixed(const EstimatorRun& run) {
  double most = 0;
  for (const NavigationEstimate& e : run.estimates()) most = std::max(most, e.hidden_ratio);
  const double found = most - (run.inputs().mask ? run.inputs().mask->hidden_ratio() : 0);
  if (!(found > 0)) return {};
  return {fmt::format(
      "{:.2g} % of the image kept its place while the rest moved (the aircraft's legs, text?) "
      "and was left out from when that had shown; calibration.mask_path leaves it out from the "
      "start",
      100 * found)};
}

// Between neighbours that the reference estimator has both seen.
std::vector<SeenTurn> seen_turns(const EstimatorRun& run) {
  std::vector<SeenTurn> out;
  std::optional<Timestamp> before;
  for (const NavigationEstimate& estimate : run.estimates()) {
    if (before && estimate.reference && estimate.reference->seen_rate_in_camera_rad_s) {
      out.push_back({*before, estimate.stamp,
                     seconds_between(*before, estimate.stamp) *
                         (run.inputs().body_from_camera.rotation *
                          *estimate.reference->seen_rate_in_camera_rad_s)});
    }
    before = estimate.stamp;
  }
  return out;
}

void tell_of_leaning_start(const EstimatorRun& run) {
  if (!run.upright()) return;
  constexpr double kWorthTelling_rad = 2 * kDegree;
  const Eigen::Quaterniond& turn = run.upright()->aligned_from_world.rotation;
  const double leans_rad = so3_log(turn).norm();
  if (leans_rad < std::max(kWorthTelling_rad, 3 * run.upright()->sigma_rad)) return;
  const EulerAngles suits = to_euler(turn * run.inputs().initial.world_from_body.rotation);
  const bool is_by_truth = run.config().initial.from_truth;
  const char* given_by = is_by_truth                  ? "the truth's first pose gives it"
                         : run.config().attitude.path ? "attitude.path gives it"
                                                      : "initial.roll_deg, initial.pitch_deg";
  fmt::print(
      stderr,
      "stillkite: the start's attitude is {:.1f} deg off the vertical that the flight shows; "
      "{} tells its poses {}; roll {:.1f} and pitch {:.1f} deg would suit ({})\n",
      leans_rad / kDegree, name_of(run.config().estimator.policy),
      is_by_truth ? "in the truth's world all the same" : "by that vertical",
      suits.roll_rad / kDegree, suits.pitch_rad / kDegree, given_by);
}

}  // namespace

EstimatorRun::EstimatorRun(RunConfig config, const Frame& first)
    : config_(std::move(config)),
      inputs_(read_flight_inputs(config_, first)),
      pilot_(make_pilot(config_, inputs_)) {}

void EstimatorRun::write_to(const std::filesystem::path& folder,
                            std::optional<std::int64_t> expected_frames) {
  const auto frames = static_cast<std::uintmax_t>(expected_frames.value_or(0));
  const std::uintmax_t bytes_per_frame =
      kBytesPerFrame + (config_.output.overlay ? kBytesPerDrawnFrame : 0);
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
      .others = readings_between(inputs_.sensors, before_.value_or(frame.stamp), frame.stamp)};
  before_ = frame.stamp;
  const RunClock::time_point start = RunClock::now();
  Frame masked = frame;
  masked.mask = inputs_.mask;
  PilotStep step = pilot_.step(masked, readings);
  frame_ms_.push_back(std::chrono::duration<float, std::milli>(RunClock::now() - start).count());
  upright_ = step.estimate.upright;
  if (!config_.initial.from_truth) step.estimate = gravity_aligned(std::move(step.estimate));
  files_->estimates.add(step.estimate);
  if (files_->commands) files_->commands->add(frame.stamp, step.decision);
  if (files_->overlay) files_->overlay->add(frame, step.estimate, pilot_.windows());
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

const std::vector<NavigationEstimate>& EstimatorRun::estimates() const {
  return files_->estimates.estimates();
}

std::optional<CommandCounts> EstimatorRun::commands() const {
  return files_->commands ? std::optional(files_->commands->counts()) : std::nullopt;
}

Ending step_through(FrameSource& source, std::span<EstimatorRun> runs, const std::string& label) {
  try {
    ProgressBar progress(label, source.expected());
    std::size_t turn = 0;
    while (!interrupted()) {
      const std::optional<Frame> frame = source.next();
      if (!frame) break;
      for (std::size_t i = 0; i < runs.size(); ++i) runs[(turn + i) % runs.size()].step(*frame);
      ++turn;
      progress.step();
    }
  } catch (const std::exception& error) {
    return {.failure = std::current_exception(), .complaint = error.what()};
  }
  return {.failure = nullptr, .complaint = source.complaint()};
}

void finish_files(std::span<EstimatorRun> runs, Ending& ending) {
  for (EstimatorRun& run : runs) {
    try {
      run.finish();
    } catch (const std::exception& error) {
      if (ending.failure) continue;
      ending = {.failure = std::current_exception(), .complaint = error.what()};
    }
  }
}

void check_row_times(const FrameSource& source, const RunConfig& config) {
  if (!source.is_turned() || config.navigator.readout_s == 0) return;
  throw InputError(fmt::format(
      "navigator.readout_s: {} is marked to be shown turned, and its rows are not read out from "
      "the top; take the mark out of the file and give the calibration of its images as they "
      "are, or leave the readout out",
      config.source.path.string()));
}

void tell_of_doubtful_inputs(std::span<const EstimatorRun> runs) {
  tell(runs, doubtful_inputs);
}

void tell_of_contradictions(const EstimatorRun& run) {
  if (const auto doubt =
          doubt_of_gyro(run.inputs().sensors.angular_rate_in_body_rad_s, seen_turns(run))) {
    fmt::print(stderr, "stillkite: {}: {}\n", run.config().imu.path ? "imu.path" : "gyro.path",
               *doubt);
    return;
  }
  tell_of_leaning_start(run);
}

void tell_of_ending(const Ending& ending, std::span<const EstimatorRun> runs,
                    const std::filesystem::path& out) {
  // a failure's is told where it is caught
  if (ending.complaint && !ending.failure) {
    fmt::print(stderr, "stillkite: {}\n", *ending.complaint);
  }
  tell(runs, uncovered_sensors);
  tell(runs, what_is_fixed);
  if (ending.failure || interrupted()) {
    fmt::print(stderr, "stillkite: stopped after {} frames; what was estimated is in {}\n",
               runs.front().estimates().size(), out.string());
  }
}

}  // namespace stillkite
