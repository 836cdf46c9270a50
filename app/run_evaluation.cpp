#include "app/run_evaluation.hpp"

#include <nlohmann/json.hpp>

#include "app/evaluation_json.hpp"

namespace stillkite {
namespace {

constexpr int kFewest = 3;  // poses of the truth at a frame, without which nothing is judged

// An IMU tells metres midway, and not how high over the ground the flight began.
bool are_places_in_metres(ScaleSource scale) {
  return scale != ScaleSource::none && scale != ScaleSource::imu;
}

EvaluationOptions options_of(const FlightInputs& inputs,
                             std::span<const NavigationEstimate> estimates) {
  return {.is_metric = are_places_in_metres(estimates.back().scale),
          .body_from_camera = inputs.body_from_camera};
}

Truth truth_of(const FlightInputs& inputs) {
  return {.poses = inputs.truth, .twists_in_camera = inputs.twists_in_camera};
}

}  // namespace

nlohmann::json run_evaluation(const FlightInputs& inputs,
                              std::span<const NavigationEstimate> estimates) {
  if (inputs.truth.empty() || estimates.empty()) return nullptr;
  const EvaluationOptions options = options_of(inputs, estimates);
  Evaluation evaluation = evaluate(judged_motions(estimates), truth_of(inputs), options);
  if (evaluation.matched < kFewest) return nullptr;
  evaluation.reference =
      reference_error(estimates, inputs.truth, inputs.body_from_camera, options.tolerance_s);
  return evaluation_json(evaluation);
}

std::vector<FrameError> run_frame_errors(const FlightInputs& inputs,
                                         std::span<const NavigationEstimate> estimates) {
  if (inputs.truth.empty() || estimates.empty()) return {};
  return frame_errors(judged_motions(estimates), truth_of(inputs), options_of(inputs, estimates));
}

std::vector<std::optional<RigidTransform>> truth_at(const FlightInputs& inputs,
                                                    std::span<const NavigationEstimate> estimates) {
  std::vector<std::optional<RigidTransform>> truth;
  if (inputs.truth.empty()) return truth;
  truth.reserve(estimates.size());
  for (const NavigationEstimate& e : estimates) {
    truth.push_back(pose_at(inputs.truth, e.stamp, EvaluationOptions{}.tolerance_s));
  }
  return truth;
}

}  // namespace stillkite
