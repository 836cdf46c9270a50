#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "app/commands.hpp"
#include "app/run_evaluation.hpp"
#include "evaluation/evaluation.hpp"
#include "geometry/angle.hpp"
#include "geometry/fields.hpp"
#include "io/dataset/calibration.hpp"
#include "io/dataset/euroc_dataset.hpp"
#include "io/dataset/trajectory_file.hpp"
#include "io/results/json_text.hpp"

namespace stillkite {
namespace {

struct EvaluateArguments {
  std::string truth;
  std::string truth_velocity;
  std::string estimate;
  std::string alignment{name_of(Alignment::none)};
  double tolerance_s = EvaluationOptions{}.tolerance_s;
  double time_offset_s = 0;
  bool json = false;
};

Alignment alignment_named(std::string_view wanted) {
  for (const auto& [value, name] : EnumNames<Alignment>::value) {
    if (name == wanted) return value;
  }
  return Alignment::none;  // CLI11 has checked the name
}

/// Ground truth; of a data set also its velocities and the camera's extrinsics.
struct TruthOnDisk {
  GroundTruth truth;
  RigidTransform body_from_camera;
};

TruthOnDisk read_truth(const EvaluateArguments& arguments) {
  TruthOnDisk result;
  if (!arguments.truth.empty()) {
    result.truth.poses = read_trajectory(arguments.truth);
    result.truth.has_attitude = has_attitude(result.truth.poses);
    const auto dataset = find_euroc_dataset(arguments.truth);
    if (dataset && dataset->camera_twists) {
      result.truth.twists_in_camera = read_twists(*dataset->camera_twists);
    }
    if (dataset && dataset->calibration) {
      const Calibration calibration = read_calibration(*dataset->calibration);
      result.body_from_camera = calibration.body_from_camera.value_or(RigidTransform{});
    }
  }
  if (!arguments.truth_velocity.empty()) {
    result.truth = with_velocities(std::move(result.truth), arguments.truth_velocity);
  }
  result.truth = with_time_offset(std::move(result.truth), arguments.time_offset_s);
  return result;
}

std::string span_text(const RowSpan& span) {
  return fmt::format("{} rows from {:.3f} s to {:.3f} s", span.rows, to_seconds(span.first),
                     to_seconds(span.last));
}

// Hint if one recording is about 10^3, 10^6 or 10^9 times longer than the other, or "".
std::string unit_hint(const RowSpan& truth, const RowSpan& estimate) {
  constexpr std::size_t kMinRows = 10;  // fewer may be a short part of the other recording
  if (truth.rows < kMinRows || estimate.rows < kMinRows) return "";
  const double truth_s = truth.duration_s(), estimate_s = estimate.duration_s();
  if (!(truth_s > 0 && estimate_s > 0)) return "";
  const double exponent = std::log10(estimate_s / truth_s);
  const double thousands = std::round(exponent / 3);
  if (thousands == 0 || std::abs(thousands) > 3 || std::abs(exponent - 3 * thousands) > 0.5) {
    return "";
  }
  constexpr std::array kUnits{"milliseconds", "microseconds", "nanoseconds"};
  return fmt::format("; the {} covers {:.3g} times the duration, so its stamps are probably {}",
                     thousands > 0 ? "estimate" : "truth", std::pow(10, std::abs(exponent)),
                     kUnits.at(static_cast<std::size_t>(std::abs(thousands)) - 1));
}

void reject_if_unmatched(const Evaluation& evaluation, const EvaluateArguments& arguments,
                         const GroundTruth& truth, const std::vector<StampedPose>& estimate) {
  if (evaluation.matched < kMinEvaluatedFrames) {
    const RowSpan of_truth = rows_of(truth);
    const RowSpan of_estimate = row_span(estimate);
    throw InputError(fmt::format(
        "{}: only {} stamps match within {} s in {}; the estimate has {}, the truth {}{}; check "
        "that both use the same clock, set --time-offset-s, or increase --tolerance-s",
        arguments.estimate, evaluation.matched, arguments.tolerance_s,
        arguments.truth.empty() ? arguments.truth_velocity : arguments.truth,
        span_text(of_estimate), span_text(of_truth), unit_hint(of_truth, of_estimate)));
  }
  if (!evaluation.alignment && !truth.poses.empty()) {
    throw InputError(fmt::format(
        "{}: --align {} is not observable from these trajectories (too little extent); use --align "
        "origin or none",
        arguments.estimate, arguments.alignment));
  }
}

void print_axes(const char* name, const std::optional<VectorError>& error, const char* unit) {
  if (!error) return;
  const auto row = [&](const char* figure, const char* figure_unit, const auto& at) {
    fmt::print("  {:<26} {:>11} {:>11} {:>11}  {}\n", fmt::format("{} {}", name, figure), at(0),
               at(1), at(2), figure_unit);
  };
  row("RMSE", unit, [&](int i) { return fmt::format("{:.5g}", error->rmse(i)); });
  row("median error", unit, [&](int i) { return fmt::format("{:.5g}", error->median_abs(i)); });
  row("correlation", "", [&](int i) {
    const auto& value = error->correlation[static_cast<std::size_t>(i)];
    return value ? fmt::format("{:.5f}", *value) : std::string("-");
  });
}

void print_relative(const char* name, const std::optional<RelativeError>& error) {
  if (!error) return;
  fmt::print("  {:<22} {:.5g} m", name, error->translation_rmse_m);
  if (error->rotation_rmse_rad) fmt::print(", {:.4g} deg", *error->rotation_rmse_rad / kDegree);
  fmt::print(" over {:.4g} m ({} pairs)\n", error->mean_length_m, error->count);
}

void print_pose(const Evaluation& evaluation) {
  const TrajectoryError& error = *evaluation.trajectory;
  fmt::print("\nPose\n");
  if (error.position) {
    fmt::print("  {:<22} {:.5g} m, maximum {:.5g} m\n", "position RMSE (ATE)",
               error.position->rmse_m, error.position->max_m);
    fmt::print("  {:<22} {:.5g} m horizontal, {:.5g} m vertical\n", "end error",
               error.position->end->horizontal_m, error.position->end->vertical_m);
  }
  if (evaluation.drift_percent) {
    fmt::print("  {:<22} {:.4g} % of the path\n", "drift", *evaluation.drift_percent);
  }
  if (error.attitude) {
    fmt::print("  {:<22} {:.4g} deg tilt, {:.4g} deg yaw\n", "attitude RMSE",
               error.attitude->tilt_rmse_rad / kDegree, error.attitude->yaw_rmse_rad / kDegree);
  } else {
    fmt::print("  {:<22} unknown: no attitude in one of the files\n", "attitude RMSE");
  }
  print_relative("relative, per frame", evaluation.per_frame);
  print_relative("relative, per metre", evaluation.per_metre);
  print_relative("relative, path / 10", evaluation.per_tenth);
}

void print_table(const Evaluation& evaluation, const EvaluateArguments& arguments,
                 std::size_t estimates) {
  fmt::print("matched {} of {} stamps", evaluation.matched, estimates);
  if (evaluation.path_length_m) {
    fmt::print(", path {:.5g} m, alignment {}", *evaluation.path_length_m, arguments.alignment);
  }
  if (evaluation.alignment && evaluation.alignment->scale != 1) {
    fmt::print(" (scale {:.6f})", evaluation.alignment->scale);
  }
  fmt::print("\n");
  if (evaluation.trajectory) print_pose(evaluation);
  if (!evaluation.velocity && !evaluation.angular_rate) return;
  // differences of poses: corrections of the trajectory appear as velocity peaks
  fmt::print("\nVelocity in the camera frame, from differences of the estimated poses\n");
  fmt::print("{:<29} {:>10} {:>11} {:>11}\n", "", "x", "y", "z");
  print_axes("velocity", evaluation.velocity, "m/s");
  print_axes("rate", evaluation.angular_rate, "rad/s");
}

void run(const EvaluateArguments& arguments) {
  if (arguments.truth.empty() && arguments.truth_velocity.empty()) {
    throw InputError("no truth; give --truth or --truth-velocity");
  }
  const TruthOnDisk disk = read_truth(arguments);
  const std::vector<StampedPose> estimate = read_trajectory(arguments.estimate);
  const std::vector<EvaluatedMotion> motions = evaluated_motions(estimate, has_attitude(estimate));
  const EvaluationOptions options{.tolerance_s = arguments.tolerance_s,
                                  .alignment = alignment_named(arguments.alignment),
                                  .body_from_camera = disk.body_from_camera};
  const Evaluation evaluation = evaluate(motions, truth_of(disk.truth, {}), options);
  reject_if_unmatched(evaluation, arguments, disk.truth, estimate);
  if (disk.truth.has_attitude && contradicts_constant_attitude(motions, disk.truth.poses)) {
    fmt::print(stderr, "stillkite: {}\n", kConstantAttitude);
  }
  if (options.alignment == Alignment::none) {
    for (const std::string& message : truth_messages(motions, truth_of(disk.truth, {}), options,
                                                     "--time-offset-s", arguments.time_offset_s)) {
      fmt::print(stderr, "stillkite: {}\n", message);
    }
  }
  if (arguments.json) {
    fmt::print("{}\n", json_text(evaluation_json(evaluation)));
  } else {
    print_table(evaluation, arguments, estimate.size());
  }
}

}  // namespace

void add_evaluate(CLI::App& app) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Evaluate an estimated trajectory against ground truth");
  command->add_option(
      "--truth", arguments->truth,
      "Ground truth: EuRoC data set or data.csv, or TUM file. With four columns, or with the "
      "identity in every row, it has no attitude");
  command->add_option("--truth-velocity", arguments->truth_velocity,
                      "True velocities as truth.velocity of a run, with or without --truth");
  command
      ->add_option("--estimate", arguments->estimate,
                   "Estimate: as --truth, or the folder of a run")
      ->required();
  std::vector<std::string> alignments;
  alignments.reserve(EnumNames<Alignment>::value.size());
  for (const auto& [value, name] : EnumNames<Alignment>::value) alignments.emplace_back(name);
  command
      ->add_option(
          "--align", arguments->alignment,
          "Alignment of the estimate to the truth: none, first pose, 4 degrees of freedom, rigid, "
          "similarity")
      ->check(CLI::IsMember(alignments).description(""))
      ->option_text("none|origin|yaw|se3|sim3");
  command->add_option("--time-offset-s", arguments->time_offset_s, "Added to the truth's stamps");
  command
      ->add_option("--tolerance-s", arguments->tolerance_s,
                   "Maximum time difference between an estimate and the nearest truth")
      ->check(CLI::Validator(
          [](const std::string& text) {
            double tolerance_s = 0;
            const bool is_valid = CLI::detail::lexical_cast(text, tolerance_s) &&
                                  tolerance_s >= 0 && std::isfinite(tolerance_s);
            return is_valid ? std::string() : text + ": expected seconds, 0 or more";
          },
          ""))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "Print the figures as JSON");
  command->footer(
      "Example: stillkite evaluate --truth truth.tum --estimate out/flight/trajectory.tum\n"
      "A run with truth evaluates itself with its own velocities: evaluation in its summary.json.");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace stillkite
