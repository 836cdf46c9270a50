#include "app/run_evaluation.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/evaluation_json.hpp"

namespace stillkite {
namespace {

Truth truth_of(const FlightInputs& inputs) {
  return {.poses = inputs.truth, .twists_in_camera = inputs.twists_in_camera};
}

}  // namespace

std::int64_t frames_with_truth(const FlightInputs& inputs,
                               std::span<const NavigationEstimate> estimates) {
  const auto truth = truth_at(inputs, estimates);
  return std::count_if(truth.begin(), truth.end(),
                       [](const auto& pose) { return pose.has_value(); });
}

nlohmann::json run_evaluation(const FlightInputs& inputs,
                              std::span<const NavigationEstimate> estimates) {
  if (frames_with_truth(inputs, estimates) < kMinEvaluatedFrames) return nullptr;
  const EvaluationOptions options{.body_from_camera = inputs.body_from_camera};
  Evaluation evaluation = evaluate(evaluated_motions(estimates), truth_of(inputs), options);
  evaluation.reference =
      reference_error(estimates, inputs.truth, inputs.body_from_camera, options.tolerance_s);
  return evaluation_json(evaluation);
}

std::vector<FrameError> run_frame_errors(const FlightInputs& inputs,
                                         std::span<const NavigationEstimate> estimates) {
  if (frames_with_truth(inputs, estimates) < kMinEvaluatedFrames) return {};
  return frame_errors(evaluated_motions(estimates), truth_of(inputs),
                      {.body_from_camera = inputs.body_from_camera});
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
