#include "io/setup/scene_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace stillkite {
namespace {

constexpr int kMinFrames = 10;
constexpr double kFlat = 0.8, kNotFlat = 0.5;  // ratios of measured frames
constexpr double kMinMeasured = 0.5;           // of the policy's estimator

}  // namespace

void VerdictCounts::add(Verdict verdict) {
  if (verdict == Verdict::first_frame) return;
  ++frames;
  if (is_measured(verdict)) ++measured;
  if (verdict == Verdict::not_flat || verdict == Verdict::too_few_inliers ||
      verdict == Verdict::lost) {
    ++not_flat;
  }
  if (verdict == Verdict::too_little_texture) ++textureless;
}

SetupFinding ground_finding(const VerdictCounts& flow) {
  SetupFinding out{.question = "ground"};
  if (flow.frames < kMinFrames) {
    out.text = fmt::format("{} images, {} needed", flow.frames, kMinFrames);
    return out;
  }
  const double ratio = flow.measured_ratio();
  out.measured = SetupMeasurement{ratio, {}, kFlat, "ratio"};
  out.verdict = SetupVerdict::ok;
  out.text = fmt::format("{}: one plane explains {:.0f} % of {} images (bounds {:g} and {:g} %){}",
                         ratio >= kFlat      ? "flat"
                         : ratio >= kNotFlat ? "flat in part"
                                             : "not flat",
                         100 * ratio, flow.frames, 100 * kNotFlat, 100 * kFlat,
                         ratio >= kFlat ? "" : "; relief, or the calibration of another lens");
  return out;
}

SetupFinding policy_finding(const EstimatorConfig& configured, const VerdictCounts& flow,
                            const VerdictCounts& reference, bool has_imu) {
  SetupFinding out{.question = "policy"};
  const double by_flow = flow.measured_ratio(), by_reference = reference.measured_ratio();
  // policy flow has no other estimator for the images that it does not measure
  const double bound = configured.policy == Policy::flow ? kFlat : kMinMeasured;
  const std::string ratios =
      fmt::format("flow measures {:.0f} %, reference {:.0f} % of {} images (bound {:g} %)",
                  100 * by_flow, 100 * by_reference, flow.frames, 100 * bound);
  if (flow.frames < kMinFrames) {
    out.text = fmt::format("{} images, {} needed", flow.frames, kMinFrames);
    return out;
  }
  const Policy fitting = has_imu               ? Policy::fused
                         : by_flow >= kFlat    ? Policy::flow
                         : by_flow >= kNotFlat ? Policy::best
                                               : Policy::reference;
  const double measured =
      configured.policy == Policy::flow ? by_flow : std::max(by_flow, by_reference);
  const bool fits = measured >= bound;
  out.verdict = fits ? SetupVerdict::ok : SetupVerdict::doubtful;
  out.measured = SetupMeasurement{measured, {}, bound, "ratio"};
  out.text = fmt::format("{}: {}", name_of(configured.policy), ratios);
  if (out.verdict != SetupVerdict::ok && fitting != configured.policy) {
    out.remedy = fmt::format("estimator: {{policy: {}}}", name_of(fitting));
  }
  return out;
}

SetupFinding accuracy_finding(const VerdictCounts& flow, const ExpectedAccuracy& accuracy) {
  constexpr double kMaxRatio = 0.1;
  SetupFinding out{.question = "accuracy"};
  if (flow.measured_ratio() < kFlat || !(accuracy.duration_s > 0)) {
    out.text = "the flow, of which it is computed, does not measure the images";
    return out;
  }
  const char* unit = accuracy.is_metric ? "m" : "initial heights";
  out.verdict = SetupVerdict::ok;
  out.measured = SetupMeasurement{accuracy.position_sigma, {}, {}, unit};
  out.text = fmt::format(
      "flow: velocity {:.2g} {}/s, position {:.2g} {} after {:.3g} {} and {:.3g} s (standard "
      "deviations, 3-D; the error of the initial height is additional)",
      accuracy.velocity_sigma, unit, accuracy.position_sigma, unit, accuracy.path_length, unit,
      accuracy.duration_s);
  const double bound = std::max(kMaxRatio * accuracy.path_length, accuracy.initial_height);
  if (accuracy.position_sigma > bound) {
    out.verdict = SetupVerdict::doubtful;
    out.text += fmt::format("; bound {:.2g} {}", bound, unit);
    out.remedy = "improve texture, lens calibration or frame rate as listed above";
  }
  return out;
}

}  // namespace stillkite
