#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "app/commands.hpp"
#include "app/evaluation_json.hpp"
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
  std::string estimate;
  std::string alignment{name_of(Alignment::none)};
  double tolerance_s = EvaluationOptions{}.tolerance_s;
  bool json = false;
};

Alignment alignment_named(std::string_view wanted) {
  for (const auto& [value, name] : EnumNames<Alignment>::value) {
    if (name == wanted) return value;
  }
  return Alignment::none;  // CLI11 has checked the name
}

/// Ground-truth trajectory; of a data set also its velocities and the camera's extrinsics.
struct TruthOnDisk {
  Truth truth;
  RigidTransform body_from_camera;
};

TruthOnDisk read_truth(const std::string& path) {
  TruthOnDisk result{.truth = {.poses = read_trajectory(path)}};
  const auto dataset = find_euroc_dataset(path);
  if (!dataset) return result;
  if (dataset->camera_twists) result.truth.twists_in_camera = read_twists(*dataset->camera_twists);
  if (dataset->calibration) {
    const Calibration calibration = read_calibration(*dataset->calibration);
    result.body_from_camera = calibration.body_from_camera.value_or(RigidTransform{});
  }
  return result;
}

std::string span_text(const std::vector<StampedPose>& poses) {
  return fmt::format("{} poses from {:.3f} s to {:.3f} s", poses.size(),
                     to_seconds(poses.front().stamp), to_seconds(poses.back().stamp));
}

void reject_if_unmatched(const Evaluation& evaluation, const EvaluateArguments& arguments,
                         const std::vector<StampedPose>& truth,
                         const std::vector<StampedPose>& estimate) {
  if (evaluation.matched < kMinEvaluatedFrames) {
    throw InputError(fmt::format(
        "{}: only {} stamps match within {} s in {}; the estimate has {}, the truth {}; check that "
        "both use the same clock, or increase --tolerance-s",
        arguments.estimate, evaluation.matched, arguments.tolerance_s, arguments.truth,
        span_text(estimate), span_text(truth)));
  }
  if (!evaluation.alignment) {
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
  fmt::print("  {:<22} {:.5g} m, {:.4g} deg over {:.4g} m ({} pairs)\n", name,
             error->translation_rmse_m, error->rotation_rmse_rad / kDegree, error->mean_length_m,
             error->count);
}

void print_table(const Evaluation& evaluation, const EvaluateArguments& arguments,
                 std::size_t estimates) {
  const TrajectoryError& error = *evaluation.trajectory;
  const PositionError& position = *error.position;
  fmt::print("matched {} of {} stamps, path {:.5g} m, alignment {}", evaluation.matched, estimates,
             evaluation.path_length_m, arguments.alignment);
  if (evaluation.alignment->scale != 1) {
    fmt::print(" (scale {:.6f})", evaluation.alignment->scale);
  }
  fmt::print("\n\nPose\n");
  fmt::print("  {:<22} {:.5g} m, maximum {:.5g} m\n", "position RMSE (ATE)", position.rmse_m,
             position.max_m);
  fmt::print("  {:<22} {:.5g} m horizontal, {:.5g} m vertical\n", "end error",
             position.end->horizontal_m, position.end->vertical_m);
  if (evaluation.drift_percent) {
    fmt::print("  {:<22} {:.4g} % of the path\n", "drift", *evaluation.drift_percent);
  }
  fmt::print("  {:<22} {:.4g} deg tilt, {:.4g} deg yaw\n", "attitude RMSE",
             error.tilt_rmse_rad / kDegree, error.yaw_rmse_rad / kDegree);
  print_relative("relative, per frame", evaluation.per_frame);
  print_relative("relative, path / 10", evaluation.per_tenth);
  // differences of poses: corrections of the trajectory appear as velocity peaks
  fmt::print("\nVelocity in the camera frame, from differences of the estimated poses\n");
  fmt::print("{:<29} {:>10} {:>11} {:>11}\n", "", "x", "y", "z");
  print_axes("velocity", evaluation.velocity, "m/s");
  print_axes("rate", evaluation.angular_rate, "rad/s");
}

void run(const EvaluateArguments& arguments) {
  const TruthOnDisk truth = read_truth(arguments.truth);
  const std::vector<StampedPose> estimate = read_trajectory(arguments.estimate);
  const Evaluation evaluation = evaluate(evaluated_motions(estimate), truth.truth,
                                         {.tolerance_s = arguments.tolerance_s,
                                          .alignment = alignment_named(arguments.alignment),
                                          .body_from_camera = truth.body_from_camera});
  reject_if_unmatched(evaluation, arguments, truth.truth.poses, estimate);
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
  command
      ->add_option("--truth", arguments->truth,
                   "Ground truth: EuRoC data set or data.csv, or TUM file")
      ->required();
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
