#include "app/run_evaluation.hpp"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "evaluation/truth_check.hpp"
#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using nlohmann::json;

json number_or_null(const std::optional<double>& value) {
  return value ? json(*value) : json();
}

json axes(const Eigen::Vector3d& value) {
  return {value.x(), value.y(), value.z()};
}

void add_trajectory(json& result, const std::optional<TrajectoryError>& error) {
  const PositionError* position = error && error->position ? &*error->position : nullptr;
  const EndError* end = position && position->end ? &*position->end : nullptr;
  const AttitudeError* attitude = error && error->attitude ? &*error->attitude : nullptr;
  result["position_rmse_m"] = position ? json(position->rmse_m) : json();
  result["position_max_m"] = position ? json(position->max_m) : json();
  result["end_error_horizontal_m"] = end ? json(end->horizontal_m) : json();
  result["end_error_vertical_m"] = end ? json(end->vertical_m) : json();
  result["tilt_rmse_rad"] = attitude ? json(attitude->tilt_rmse_rad) : json();
  result["yaw_rmse_rad"] = attitude ? json(attitude->yaw_rmse_rad) : json();
}

void add_vector(json& result, const std::string& name, const std::string& unit,
                const std::optional<VectorError>& error) {
  json correlation;
  if (error) {
    for (const auto& axis : error->correlation) correlation.push_back(number_or_null(axis));
  }
  result[name + "_rmse_" + unit] = error ? axes(error->rmse) : json();
  result[name + "_median_abs_error_" + unit] = error ? axes(error->median_abs) : json();
  result[name + "_correlation"] = correlation;
}

json relative_json(const std::optional<RelativeError>& error) {
  if (!error) return {};
  return {{"count", error->count},
          {"mean_length_m", error->mean_length_m},
          {"translation_rmse_m", error->translation_rmse_m},
          {"rotation_rmse_rad", number_or_null(error->rotation_rmse_rad)}};
}

json nees_json(const std::optional<Consistency>& consistency) {
  if (!consistency) return {};
  return {{"mean", consistency->mean},
          {"degrees_of_freedom", consistency->degrees_of_freedom},
          {"samples", consistency->samples},
          {"mean_low", consistency->mean_low},
          {"mean_high", consistency->mean_high},
          {"share_inside", consistency->share_inside}};
}

json consistency_json(const std::optional<Consistency>& consistency) {
  if (!consistency) return {};
  return {{"samples", consistency->samples},
          {"share_beyond_3_sigma", consistency->share_beyond_3_sigma},
          {"share_beyond_5_sigma", consistency->share_beyond_5_sigma},
          {"sigma_over_rms", number_or_null(consistency->sigma_over_rms)}};
}

// Relative poses to the reference frame; policy flow has none.
json reference_json(const std::optional<ReferenceError>& error) {
  const auto figure = [&](const auto& value) { return error ? number_or_null(value) : json(); };
  const ReferenceError of = error.value_or(ReferenceError{});
  return {{"rotation_median_deg", figure(std::optional(of.rotation_median_deg))},
          {"direction_median_deg", figure(of.direction_median_deg)},
          {"displacement_rmse_m", figure(of.displacement_rmse_m)},
          {"rotations", of.rotations},
          {"directions", of.directions}};
}

EvaluationOptions options_of(const FlightInputs& inputs) {
  return {.body_from_camera = inputs.body_from_camera};
}

std::string description_of(const TruthMismatch& mismatch, std::string_view offset_option,
                           double offset_s) {
  const double percent = 100 * mismatch.explained_ratio;
  switch (mismatch.cause) {
    case TruthMismatch::Cause::clock:
      return fmt::format(
          "truth: a clock {:.2f} s {} explains {:.0f} % of the difference in speed: set {} to "
          "{:.2f}",
          std::abs(mismatch.value), mismatch.value > 0 ? "ahead" : "behind", percent, offset_option,
          offset_s - mismatch.value);
    case TruthMismatch::Cause::heading:
      return fmt::format(
          "truth: a rotation of {:.1f} deg about the vertical explains {:.0f} % of the position "
          "error; check that its positions and attitudes are in one world frame, and the initial "
          "yaw, or compare with stillkite evaluate --align yaw",
          mismatch.value / kDegree, percent);
    default:
      return fmt::format(
          "truth: lengths are {:.3g} times those of the estimate; give the truth in metres, and "
          "check the initial height",
          mismatch.value);
  }
}

}  // namespace

Truth truth_of(const GroundTruth& truth, const TruthConfig& config) {
  return {.poses = truth.poses,
          .has_attitude = truth.has_attitude,
          .twists_in_camera = truth.twists_in_camera,
          .velocities = truth.velocities,
          .sigma = {.position_m = config.position_sigma_m,
                    .attitude_rad = config.attitude_sigma_deg * kDegree,
                    .velocity_m_s = config.velocity_sigma_m_s,
                    .angular_rate_rad_s = config.angular_rate_sigma_deg_s * kDegree}};
}

std::int64_t frames_with_truth(const FlightInputs& inputs,
                               std::span<const EvaluatedMotion> motions) {
  return evaluate(motions, truth_of(inputs.truth, {}), options_of(inputs)).matched;
}

std::vector<std::string> truth_messages(std::span<const EvaluatedMotion> motions,
                                        const Truth& truth, const EvaluationOptions& options,
                                        std::string_view offset_option, double offset_s) {
  std::vector<std::string> messages;
  if (const std::optional<TruthJump> jump = truth_jump(truth.poses)) {
    messages.push_back(fmt::format(
        "truth: {} jump(s) of its position, the largest {:.2g} m before {:.3f} s; remove outliers "
        "and rows without tracking",
        jump->count, jump->length_m, to_seconds(jump->stamp)));
  }
  if (const std::optional<TruthMismatch> mismatch = truth_mismatch(motions, truth, options)) {
    messages.push_back(description_of(*mismatch, offset_option, offset_s));
  }
  return messages;
}

json evaluation_json(const Evaluation& evaluation) {
  json result{{"matched", evaluation.matched},
              {"path_length_m", number_or_null(evaluation.path_length_m)}};
  add_trajectory(result, evaluation.trajectory);
  result["drift_percent"] = number_or_null(evaluation.drift_percent);
  result["position_rmse_percent"] = number_or_null(evaluation.rmse_percent);
  add_vector(result, "velocity", "m_s", evaluation.velocity);
  add_vector(result, "angular_rate", "rad_s", evaluation.angular_rate);
  result["relative"] = {{"per_frame", relative_json(evaluation.per_frame)},
                        {"per_metre", relative_json(evaluation.per_metre)},
                        {"per_tenth_of_path", relative_json(evaluation.per_tenth)}};
  const ReferenceError reference = evaluation.reference.value_or(ReferenceError{});
  result["reference"] = reference_json(evaluation.reference);
  const auto& [position, attitude, velocity, angular_rate] = evaluation.nees;
  result["nees"] = {{"position", nees_json(position)},
                    {"attitude", nees_json(attitude)},
                    {"velocity", nees_json(velocity)},
                    {"angular_rate", nees_json(angular_rate)},
                    {"reference_rotation", nees_json(reference.rotation_nees)},
                    {"reference_direction", nees_json(reference.direction_nees)}};
  result["consistency"] = {{"position", consistency_json(position)},
                           {"attitude", consistency_json(attitude)},
                           {"velocity", consistency_json(velocity)},
                           {"angular_rate", consistency_json(angular_rate)}};
  return result;
}

json run_evaluation(const FlightInputs& inputs, const TruthConfig& config,
                    std::span<const EvaluatedMotion> motions,
                    const std::optional<ReferenceError>& reference) {
  Evaluation evaluation = evaluate(motions, truth_of(inputs.truth, config), options_of(inputs));
  if (evaluation.matched < kMinEvaluatedFrames) return nullptr;
  evaluation.reference = reference;
  return evaluation_json(evaluation);
}

std::vector<FrameError> run_frame_errors(const FlightInputs& inputs,
                                         std::span<const EvaluatedMotion> motions) {
  if (frames_with_truth(inputs, motions) < kMinEvaluatedFrames) return {};
  return frame_errors(motions, truth_of(inputs.truth, {}), options_of(inputs));
}

}  // namespace stillkite
