#include "app/run_warnings.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "app/inertial_messages.hpp"
#include "app/interrupt.hpp"
#include "app/run_evaluation.hpp"
#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "io/dataset/sensor_checks.hpp"
#include "io/setup/camera_findings.hpp"

namespace stillkite {
namespace {

using Messages = std::vector<std::string>;

// One message per sensor log or truth that does not cover the flight.
Messages uncovered_sensors(const EstimatorRun& run) {
  const RunTally& tally = run.record().tally;
  if (!tally.last) return {};
  const Timestamp first = *tally.first_stamp, last = tally.last->stamp;
  Messages messages = coverage_warnings(run.inputs().sensors, first, last);
  if (run.inputs().truth.empty()) return messages;
  if (run.inputs().truth.has_attitude &&
      contradicts_constant_attitude(run.record().motions, run.inputs().truth.poses)) {
    messages.emplace_back(kConstantAttitude);
  }
  const std::int64_t matched = frames_with_truth(run.inputs(), run.record().motions);
  if (matched >= kMinEvaluatedFrames) {
    for (std::string& message :
         truth_messages(run.record().motions, truth_of(run.inputs().truth, {}),
                        {.body_from_camera = run.inputs().body_from_camera}, "truth.time_offset_s",
                        run.config().truth.time_offset_s)) {
      messages.push_back(std::move(message));
    }
    return messages;
  }
  const RowSpan truth = rows_of(run.inputs().truth);
  messages.push_back(fmt::format(
      "truth: rows at only {} images, no evaluation; it covers {:.3f} s to {:.3f} s, the images "
      "{:.3f} s to {:.3f} s; check that both use the same clock, or set truth.time_offset_s",
      matched, to_seconds(truth.first), to_seconds(truth.last), to_seconds(first),
      to_seconds(last)));
  return messages;
}

std::optional<std::string> missing_scale(const FlightInputs& inputs) {
  if (inputs.initial.scale != ScaleSource::none) return std::nullopt;
  return fmt::format(
      "no metric scale: lengths are in initial heights over the ground; set initial.height_m{}",
      inputs.sensors.imu.stamps.empty()
          ? ""
          : "; with estimator.policy=fused in metres once the column scale is imu");
}

// z of map coordinates (UTM) is usually above sea level, not above the ground.
std::optional<std::string> height_above_sea_level(const EstimatorRun& run) {
  constexpr double kMaxDistance_m = 10'000;
  const Eigen::Vector3d& position = run.inputs().initial.world_from_body.translation;
  const bool is_local = position.head<2>().norm() < kMaxDistance_m;
  if (!run.config().initial.from_truth || run.config().truth.ground_z_m != 0 || is_local) {
    return std::nullopt;
  }
  return fmt::format(
      "initial.from_truth: the truth is {:.0f} km from its origin (map coordinates), and its z of "
      "{:.1f} m is taken as the height above the ground; set truth.ground_z_m",
      1e-3 * position.head<2>().norm(), position.z());
}

std::optional<std::string> unused_by_the_window(const RunConfig& config) {
  if (config.estimator.policy != Policy::fused ||
      config.navigator.fusion.solver != FusionSolver::window) {
    return std::nullopt;
  }
  std::string keys;
  const auto add = [&](bool is_set, std::string_view key) {
    if (is_set) keys += (keys.empty() ? "" : ", ") + std::string(key);
  };
  add(config.height.path.has_value(), "height.path");
  add(config.attitude.path.has_value(), "attitude.path");
  add(config.navigator.readout_s > 0, "navigator.readout_s");
  if (keys.empty()) return std::nullopt;
  return keys + ": not used by fusion.solver=window";
}

std::optional<std::string> diverging_filter(const EstimatorRun& run) {
  const RunConfig& config = run.config();
  const bool is_filter = config.estimator.policy == Policy::fused &&
                         config.navigator.fusion.solver == FusionSolver::filter;
  const bool has_scale =
      run.inputs().initial.scale != ScaleSource::none || config.height.path.has_value();
  if (!is_filter || has_scale || run.inputs().sensors.imu.stamps.empty()) return std::nullopt;
  return "fusion.solver=filter can diverge without a height; set fusion.solver=window, "
         "initial.height_m or height.path";
}

Messages input_warnings(const EstimatorRun& run) {
  Messages messages;
  if (const auto message = unused_by_the_window(run.config())) messages.push_back(*message);
  if (const auto message = missing_scale(run.inputs())) messages.push_back(*message);
  if (const auto message = diverging_filter(run)) messages.push_back(*message);
  if (const auto message =
          no_ground_in_view(run.inputs().camera, run.inputs().initial.world_from_body.rotation *
                                                     run.inputs().body_from_camera.rotation))
    messages.push_back(*message);
  if (const auto message = height_above_sea_level(run)) messages.push_back(*message);
  if (run.inputs().mount_note) messages.push_back(*run.inputs().mount_note);
  const GroundTruth& truth = run.inputs().truth;
  if (!truth.has_attitude && run.config().truth.path) {
    messages.emplace_back(
        "truth.path: no attitude (four columns, or the identity in every row), so only positions "
        "and velocities are evaluated");
  }
  if (const std::size_t rejected = run.inputs().sensors.rejected_imu_readings; rejected > 0) {
    messages.push_back(fmt::format(
        "imu.path: rejected {} of {} readings: all zero, the same for 0.25 s or more (sensor or "
        "driver stopped), or outliers to both neighbours",
        rejected, rejected + run.inputs().sensors.imu.stamps.size()));
  }
  constexpr double kMaxLeverArm_m = 0.01;
  if (const double arm_m = run.inputs().sensors.imu_lever_arm_m; arm_m > kMaxLeverArm_m) {
    messages.push_back(fmt::format(
        "imu.path: T_BS of its sensor.yaml places the IMU {:.3g} m from the body's origin; the "
        "lever arm is not modelled: use the IMU as the body",
        arm_m));
  }
  if (run.config().acceleration.path && run.config().estimator.mode_in_use() != Mode::paper) {
    messages.emplace_back("acceleration.path: used only by estimator.mode=paper");
  }
  if (run.inputs().mask && run.config().estimator.mode_in_use() == Mode::paper &&
      run.config().estimator.policy != Policy::reference) {
    messages.emplace_back("calibration.mask_path: not used by the flow of estimator.mode=paper");
  }
  return messages;
}

// Prints a message that several estimators share once.
void report_once(std::span<const EstimatorRun> runs, Messages (*messages_of)(const EstimatorRun&)) {
  std::set<std::string> printed;
  for (const EstimatorRun& run : runs) {
    for (const std::string& message : messages_of(run)) {
      if (printed.insert(message).second) fmt::print(stderr, "stillkite: {}\n", message);
    }
  }
}

// Detected overlays and airframe outside the configured mask.
Messages static_overlay_warnings(const EstimatorRun& run) {
  const double detected = run.record().tally.max_masked_ratio -
                          (run.inputs().mask ? run.inputs().mask->masked_ratio() : 0);
  if (!(detected > 0)) return {};
  return {fmt::format(
      "{:.2g} % of the image is static (text overlay or airframe in view) and is masked since its "
      "detection; calibration.mask_path masks it from the first frame",
      100 * detected)};
}

void report_initial_attitude_error(const EstimatorRun& run) {
  if (!run.gravity_alignment()) return;
  constexpr double kMinReported_rad = 2 * kDegree;
  const Eigen::Quaterniond& aligned_from_world =
      run.gravity_alignment()->aligned_from_world.rotation;
  const double error_rad = so3_log(aligned_from_world).norm();
  if (error_rad < std::max(kMinReported_rad, 3 * run.gravity_alignment()->sigma_rad)) return;
  const EulerAngles estimated =
      to_euler(aligned_from_world * run.inputs().initial.world_from_body.rotation);
  const bool is_by_truth = run.starts_from_true_attitude();
  const char* source = is_by_truth                  ? "the truth's first pose"
                       : run.config().attitude.path ? "attitude.path"
                                                    : "initial.roll_deg, initial.pitch_deg";
  fmt::print(stderr,
             "stillkite: initial attitude disagrees with gravity by {:.1f} deg (estimated roll "
             "{:.1f}, pitch {:.1f} deg); source: {}; poses of {}: {}\n",
             error_rad / kDegree, estimated.roll_rad / kDegree, estimated.pitch_rad / kDegree,
             source, name_of(run.config().estimator.policy),
             is_by_truth ? "in the truth's world, not aligned" : "gravity-aligned");
}

}  // namespace

void report_input_warnings(std::span<const EstimatorRun> runs) {
  report_once(runs, input_warnings);
}

void report_inconsistencies(const EstimatorRun& run) {
  const std::vector<InertialFinding> findings = run.inertial_findings();
  // the window's estimate of the clock is the more accurate one
  const bool is_clock_known = std::ranges::any_of(findings, [](const InertialFinding& finding) {
    return finding.fault == InertialFault::clock;
  });
  const auto inconsistency =
      is_clock_known ? std::nullopt
                     : gyro_inconsistency(run.inputs().sensors.angular_rate_in_body_rad_s,
                                          run.record().rotations);
  if (inconsistency) {
    fmt::print(stderr, "stillkite: {}: {}\n", run.config().imu.path ? "imu.path" : "gyro.path",
               *inconsistency);
    return;
  }
  for (const std::string& message : inertial_messages(findings, run.config())) {
    fmt::print(stderr, "stillkite: {}\n", message);
  }
  report_initial_attitude_error(run);
}

void report_outcome(const RunOutcome& outcome, std::span<const EstimatorRun> runs,
                    const std::filesystem::path& out) {
  // main() reports the message of a failure
  if (outcome.problem && !outcome.failure) {
    fmt::print(stderr, "stillkite: {}\n", *outcome.problem);
  }
  report_once(runs, uncovered_sensors);
  report_once(runs, static_overlay_warnings);
  if (outcome.failure || interrupted()) {
    fmt::print(stderr, "stillkite: stopped after {} frames; their results are in {}\n",
               runs.front().record().tally.frames, out.string());
  }
}

}  // namespace stillkite
