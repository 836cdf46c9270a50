#include "app/run_evaluation.hpp"

#include <nlohmann/json.hpp>

#include "app/evaluation_json.hpp"
#include "geometry/angle.hpp"

namespace stillkite {
namespace {

EvaluationOptions options_of(const FlightInputs& inputs) {
  return {.body_from_camera = inputs.body_from_camera};
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

nlohmann::json run_evaluation(const FlightInputs& inputs, const TruthConfig& config,
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
