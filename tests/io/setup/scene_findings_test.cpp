#include "io/setup/scene_findings.hpp"

#include <gtest/gtest.h>

#include "io/setup/block_statistics.hpp"
#include "io/setup/camera_findings.hpp"

namespace stillkite {
namespace {

VerdictCounts counts(int measured, int not_flat) {
  VerdictCounts out;
  for (int i = 0; i < measured; ++i) out.add(Verdict::ok);
  for (int i = 0; i < not_flat; ++i) out.add(Verdict::not_flat);
  return out;
}

TEST(SceneFindings, PolicyFlowDoesNotFitARoom) {
  const auto finding = [](Policy policy, bool has_imu) {
    return policy_finding({.policy = policy}, counts(20, 80), counts(95, 5), has_imu);
  };
  EXPECT_EQ(finding(Policy::flow, false).verdict, SetupVerdict::doubtful);
  EXPECT_EQ(finding(Policy::flow, false).remedy, "estimator: {policy: reference}");
  EXPECT_EQ(finding(Policy::flow, true).remedy, "estimator: {policy: fused}");
  EXPECT_EQ(finding(Policy::fused, true).verdict, SetupVerdict::ok);
  EXPECT_EQ(policy_finding({}, counts(95, 5), counts(95, 5), false).verdict, SetupVerdict::ok);
}

// As with the lens of another camera, 9 % off in focal length, over a board.
TEST(SceneFindings, PolicyFlowNeedsAPlaneInMostImages) {
  const SetupFinding flow =
      policy_finding({.policy = Policy::flow}, counts(54, 46), counts(97, 3), false);
  EXPECT_EQ(flow.verdict, SetupVerdict::doubtful);
  EXPECT_EQ(flow.remedy, "estimator: {policy: best}");
  EXPECT_EQ(policy_finding({.policy = Policy::best}, counts(54, 46), counts(97, 3), false).verdict,
            SetupVerdict::ok);
}

TEST(SceneFindings, GroundIsNamedByItsMeasuredShare) {
  EXPECT_EQ(ground_finding(counts(90, 10)).text.find("flat: "), 0u);
  EXPECT_EQ(ground_finding(counts(60, 40)).text.find("flat in part: "), 0u);
  EXPECT_EQ(ground_finding(counts(10, 90)).text.find("not flat: "), 0u);
  EXPECT_EQ(ground_finding(counts(3, 0)).verdict, SetupVerdict::cannot_tell);
}

TEST(SceneFindings, AccuracyIsComputedOfTheFlowOnly) {
  const ExpectedAccuracy accuracy{.position_sigma = 0.1,
                                  .path_length = 20,
                                  .velocity_sigma = 0.01,
                                  .is_metric = true,
                                  .duration_s = 10};
  EXPECT_EQ(accuracy_finding(counts(90, 10), accuracy).verdict, SetupVerdict::ok);
  EXPECT_EQ(accuracy_finding(counts(10, 90), accuracy).verdict, SetupVerdict::cannot_tell);
  ExpectedAccuracy poor = accuracy;
  poor.position_sigma = 3;  // 10 % of the path: 2; initial height: 1
  EXPECT_EQ(accuracy_finding(counts(90, 10), poor).verdict, SetupVerdict::doubtful);
}

TEST(CameraFindings, ScaledCalibrationKeepsTheFieldOfView) {
  const Camera camera{.width_px = 640,
                      .height_px = 480,
                      .focal_x_px = 500,
                      .focal_y_px = 510,
                      .centre_x_px = 319.5,
                      .centre_y_px = 239.5};
  const SetupFinding wrong = resolution_finding(camera, 1280, 960);
  EXPECT_EQ(wrong.verdict, SetupVerdict::wrong);
  EXPECT_NE(wrong.remedy.find("focal_x_px: 1000, focal_y_px: 1020, centre_x_px: 639.5"),
            std::string::npos)
      << wrong.remedy;
  EXPECT_EQ(resolution_finding(camera, 640, 480).verdict, SetupVerdict::ok);
  const SetupFinding cropped = resolution_finding(camera, 1280, 720);
  EXPECT_EQ(cropped.verdict, SetupVerdict::wrong);
  EXPECT_EQ(cropped.remedy.find("camera:"), std::string::npos) << cropped.remedy;
}

TEST(CameraFindings, ALensThatFoldsIsWrong) {
  Camera camera{.width_px = 640,
                .height_px = 480,
                .focal_x_px = 300,
                .focal_y_px = 300,
                .centre_x_px = 319.5,
                .centre_y_px = 239.5,
                .distortion = DistortionModel::radial_tangential,
                .coefficients = {-0.05}};
  EXPECT_EQ(lens_finding(camera, nullptr, "x").verdict, SetupVerdict::ok);
  camera.coefficients = {-0.4};  // folds at r = 0.91, the corners are at 1.33
  EXPECT_EQ(lens_finding(camera, nullptr, "x").verdict, SetupVerdict::wrong);
}

// Jackknife of a mean: the standard error of independent samples.
TEST(BlockStatistics, JackknifeOfAMeanIsItsStandardError) {
  double squares = 0;
  constexpr int kSeries = 200;
  constexpr std::size_t kSamples = 200;
  unsigned state = 1;
  const auto uniform = [&state] {
    state = state * 1664525u + 1013904223u;
    return state / 4294967296.0;
  };
  for (int series = 0; series < kSeries; ++series) {
    std::vector<double> samples(kSamples);
    for (double& sample : samples) sample = uniform();
    const BlockEstimate estimate = block_jackknife(kSamples, [&](const auto& excluded) {
      double sum = 0, n = 0;
      for (std::size_t i = 0; i < kSamples; ++i) {
        if (excluded(i)) continue;
        sum += samples[i];
        n += 1;
      }
      return sum / n;
    });
    squares += estimate.sigma * estimate.sigma / kSeries;
  }
  EXPECT_NEAR(squares, 1.0 / 12 / kSamples, 0.1 / 12 / kSamples);
}

TEST(SetupFinding, TheWorstVerdictCounts) {
  const auto findings = [](SetupVerdict a, SetupVerdict b) {
    return SetupFindings{{.question = "a", .verdict = a}, {.question = "b", .verdict = b}};
  };
  EXPECT_EQ(worst_verdict(findings(SetupVerdict::doubtful, SetupVerdict::wrong)),
            SetupVerdict::wrong);
  EXPECT_EQ(worst_verdict(findings(SetupVerdict::ok, SetupVerdict::doubtful)),
            SetupVerdict::doubtful);
  EXPECT_EQ(worst_verdict(findings(SetupVerdict::cannot_tell, SetupVerdict::ok)), SetupVerdict::ok);
}

}  // namespace
}  // namespace stillkite
