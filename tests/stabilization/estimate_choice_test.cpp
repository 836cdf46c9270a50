#include "stabilization/estimate_choice.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using Eigen::Vector3d;

const int kPatience = EstimateChoiceConfig{}.patience_frames;
constexpr double kHeight_m = 3;

MotionEstimate flow_at(const Vector3d& translation_m, double yaw_deg = 0) {
  MotionEstimate motion;
  motion.source = EstimateSource::flow;
  motion.status = EstimateStatus::ok;
  motion.reference_from_camera = so3_exp({0, 0, yaw_deg * kDegree});
  motion.rotation_covariance = 1e-6 * Eigen::Matrix3d::Identity();
  motion.displacement_kind = DisplacementKind::metric;
  motion.displacement_in_reference = translation_m;
  motion.displacement_covariance = 1e-6 * Eigen::Matrix3d::Identity();
  return motion;
}

MotionEstimate reference_towards(const Vector3d& translation, double yaw_deg = 0) {
  MotionEstimate motion = flow_at(translation.stableNormalized(), yaw_deg);
  motion.source = EstimateSource::reference;
  motion.displacement_kind =
      translation.isZero() ? DisplacementKind::zero : DisplacementKind::direction;
  return motion;
}

MotionEstimate lost(MotionEstimate motion) {
  motion.status = EstimateStatus::lost;
  return motion;
}

EstimatePair pair_of(const MotionEstimate& flow, const MotionEstimate& reference,
                     std::optional<double> relief_ratio = 0,
                     std::optional<double> misfit_ratio = {}) {
  return {.flow = flow,
          .reference = reference,
          .initial_from_reference = {},
          .relief_ratio = relief_ratio,
          .misfit_ratio = misfit_ratio,
          .initial_height = kHeight_m};
}

// Source after `frames` identical frames.
EstimateSource source_after(EstimateChoice& choice, const EstimatePair& estimates, int frames) {
  EstimateDecision decision;
  for (int i = 0; i < frames; ++i) decision = choice.step(estimates);
  return decision.source;
}

const Vector3d kForward(1, 0, 0);
const Vector3d kLeft(0, 1, 0);

TEST(EstimateChoice, SelectsFlowWhileConsistent) {
  EstimateChoice choice({});
  const EstimatePair consistent = pair_of(flow_at(kForward, 2), reference_towards(kForward, 2.5));
  EXPECT_EQ(source_after(choice, consistent, 20), EstimateSource::flow);
  const EstimateDecision decision = choice.step(consistent);
  EXPECT_TRUE(decision.initial_from_camera.translation.isApprox(kForward));
  EXPECT_NEAR(so3_log(decision.initial_from_camera.rotation).z(), 2 * kDegree, 1e-12);
  EXPECT_TRUE(decision.correction_covariance.isZero());
}

// Cases: rotation, direction, opposite direction, displacement against zero, relief.
TEST(EstimateChoice, SwitchesToReferenceAfterInconsistentFrames) {
  const MotionEstimate forward = flow_at(kForward);
  for (const EstimatePair& pair : {pair_of(flow_at(kForward, 4), reference_towards(kForward)),
                                   pair_of(forward, reference_towards(kForward + 0.3 * kLeft)),
                                   pair_of(forward, reference_towards(-kForward)),
                                   pair_of(forward, reference_towards(Vector3d::Zero())),
                                   pair_of(forward, reference_towards(kForward), 0.5)}) {
    EstimateChoice choice({});
    EXPECT_EQ(source_after(choice, pair, kPatience - 1), EstimateSource::flow);
    const EstimateDecision decision = choice.step(pair);
    EXPECT_EQ(decision.source, EstimateSource::reference);
    EXPECT_TRUE(
        decision.initial_from_camera.rotation.isApprox(pair.reference.reference_from_camera));
  }
}

TEST(EstimateChoice, TestsConsistencyWithBothCovariances) {
  MotionEstimate uncertain = reference_towards(kForward + 0.3 * kLeft, 4);
  uncertain.rotation_covariance = 0.04 * 0.04 * Eigen::Matrix3d::Identity();
  uncertain.displacement_covariance = 0.1 * 0.1 * Eigen::Matrix3d::Identity();
  EstimateChoice choice({});
  EXPECT_EQ(source_after(choice, pair_of(flow_at(kForward), uncertain), 20), EstimateSource::flow);
}

// Three degrees of freedom: the quantile of 3 sigma, 99.73 %, is 14.156 = 3.7625^2.
TEST(EstimateChoice, AgreementIsAQuantileOfThreeComponents) {
  const auto source_at = [](double rotation_sigmas) {
    EstimatePair pair =
        pair_of(flow_at(kForward, rotation_sigmas * EstimateChoiceConfig{}.rotation_sigma_deg),
                reference_towards(kForward));
    pair.flow.rotation_covariance.setZero();
    pair.reference.rotation_covariance.setZero();
    EstimateChoice choice({});
    return source_after(choice, pair, kPatience);
  };
  EXPECT_EQ(source_at(3.76), EstimateSource::flow);
  EXPECT_EQ(source_at(3.77), EstimateSource::reference);
}

TEST(EstimateChoice, KeepsReliefResultUntilParallaxSuffices) {
  EstimateChoice choice({});
  const MotionEstimate flow = flow_at(kForward);
  const MotionEstimate reference = reference_towards(kForward);
  EXPECT_EQ(source_after(choice, pair_of(flow, reference, 0.5), 20), EstimateSource::reference);
  EXPECT_EQ(source_after(choice, pair_of(flow, reference, {}), 20), EstimateSource::reference);
  EXPECT_EQ(source_after(choice, pair_of(flow, reference, 0.05), kPatience - 1),
            EstimateSource::reference);
  EXPECT_EQ(source_after(choice, pair_of(flow, reference, 0.05), 1), EstimateSource::flow);
}

// Without sufficient parallax the relief of the ground is unknown.
TEST(EstimateChoice, BoundsFlowErrorUntilFlatGroundIsVerified) {
  EstimateChoice choice({});
  const auto error_bound = [&](const Vector3d& translation, std::optional<double> relief_ratio) {
    const EstimatePair pair =
        pair_of(flow_at(translation), reference_towards(translation), relief_ratio);
    return choice.step(pair).position_error_bound;
  };
  EXPECT_DOUBLE_EQ(error_bound(0.2 * kForward, {}), 0.2);
  EXPECT_DOUBLE_EQ(error_bound(0.1 * kLeft, {}), 0.2);  // largest displacement
  EXPECT_EQ(error_bound(0.3 * kForward, 0.05), 0);
  EXPECT_EQ(error_bound(0.1 * kForward, {}), 0);
  EXPECT_DOUBLE_EQ(error_bound(0.4 * kForward, 0.5), 0.3);  // flow is still selected
  EstimateChoice rotated({});
  const EstimatePair pair = pair_of(flow_at(0.1 * kForward, 3), reference_towards(kForward), {});
  EXPECT_NEAR(rotated.step(pair).position_error_bound, kHeight_m * 3 * kDegree, 1e-12);
}

// False reference pose, as from an essential matrix on a plane.
TEST(EstimateChoice, SelectsFlowWhoseMotionExplainsTheFeatures) {
  EstimateChoice choice({});
  const EstimatePair false_pose =
      pair_of(flow_at(kForward), reference_towards(kLeft, 10), 0.9, 0.05);
  EXPECT_EQ(source_after(choice, false_pose, 20), EstimateSource::flow);
  EXPECT_TRUE(choice.step(false_pose).initial_from_flow.translation.isZero());
  const EstimatePair true_pose = pair_of(flow_at(kForward), reference_towards(kLeft, 10), 0.9, 0.9);
  EXPECT_EQ(source_after(choice, true_pose, 20), EstimateSource::reference);
}

TEST(EstimateChoice, RejectsFlowOverGroundWithRelief) {
  EstimateChoice choice({});
  const MotionEstimate flow = flow_at(kForward);
  const MotionEstimate reference = reference_towards(kForward);
  EXPECT_EQ(source_after(choice, pair_of(flow, reference, 0.5), 20), EstimateSource::reference);
  EXPECT_EQ(source_after(choice, pair_of(flow, lost(reference), {}), 20),
            EstimateSource::reference);
  // accepted once its motion explains the features
  EXPECT_EQ(source_after(choice, pair_of(flow, lost(reference), {}, 0.1), 1), EstimateSource::flow);
}

TEST(EstimateChoice, DoesNotChatterOnSingleFrames) {
  EstimateChoice choice({});
  for (int i = 0; i < 100; ++i) {
    const double relief_ratio = i % kPatience == 0 ? 0 : 1;
    EXPECT_EQ(
        choice.step(pair_of(flow_at(kForward), reference_towards(kForward), relief_ratio)).source,
        EstimateSource::flow);
  }
}

TEST(EstimateChoice, ReplacesLostEstimateAtOnce) {
  const MotionEstimate flow = flow_at(kForward);
  const MotionEstimate reference = reference_towards(kForward);
  EstimateChoice choice({});
  EXPECT_EQ(choice.step(pair_of(lost(flow), reference)).source, EstimateSource::reference);
  EXPECT_EQ(choice.step(pair_of(flow, reference)).source, EstimateSource::reference);
  MotionEstimate gated = reference;
  gated.status = EstimateStatus::gated;
  EXPECT_EQ(choice.step(pair_of(flow, gated)).source, EstimateSource::flow);
}

TEST(EstimateChoice, KeepsSourceAndPoseWhenBothAreLost) {
  for (const bool flow_first : {true, false}) {
    EstimateChoice choice({});
    const MotionEstimate flow = flow_at(kForward);
    const MotionEstimate reference = reference_towards(kForward, 1);
    const EstimateDecision before = flow_first ? choice.step(pair_of(flow, lost(reference)))
                                               : choice.step(pair_of(lost(flow), reference));
    const EstimateDecision after_loss = choice.step(pair_of(lost(flow), lost(reference)));
    EXPECT_EQ(after_loss.source, flow_first ? EstimateSource::flow : EstimateSource::reference);
    EXPECT_TRUE(
        after_loss.initial_from_camera.rotation.isApprox(before.initial_from_camera.rotation));
    EXPECT_TRUE(after_loss.initial_from_camera.translation.isApprox(
        before.initial_from_camera.translation));
  }
}

// The reference is exact; the flow has drifted laterally, along its direction and in heading.
TEST(EstimateChoice, ContinuesFlowFromReferencePose) {
  EstimateChoice choice({});
  const MotionEstimate reference = reference_towards(kForward, 5);
  const MotionEstimate drifted = flow_at(1.2 * kForward + 0.4 * kLeft, 9);
  EXPECT_EQ(source_after(choice, pair_of(drifted, reference), kPatience),
            EstimateSource::reference);
  const EstimateDecision before = choice.step(pair_of(drifted, reference));
  // d d^T c with d forward
  EXPECT_TRUE(before.initial_from_camera.translation.isApprox(1.2 * kForward, 1e-9));
  // 0.1 m further along the flow's heading, which has an error of 4 degrees
  const Vector3d further = 0.1 * (so3_exp({0, 0, 9 * kDegree}) * kForward);
  const MotionEstimate next = flow_at(drifted.displacement_in_reference + further, 9);
  const EstimateDecision after = choice.step(pair_of(next, lost(reference)));
  EXPECT_EQ(after.source, EstimateSource::flow);
  EXPECT_NEAR(so3_log(after.initial_from_camera.rotation).z(), 5 * kDegree, 1e-9);
  const Vector3d along_true_heading = 0.1 * (so3_exp({0, 0, 5 * kDegree}) * kForward);
  EXPECT_TRUE(
      after.initial_from_camera.translation.isApprox(1.2 * kForward + along_true_heading, 1e-9));
  // the error across is also the standard deviation along
  EXPECT_GT(after.correction_covariance(0, 0), 0.1);
}

TEST(EstimateChoice, ResetsFlowTranslationAtTheReferencePose) {
  EstimateChoice choice({});
  const MotionEstimate drifted = flow_at(0.5 * kLeft, 0);
  const EstimatePair at_reference = pair_of(drifted, reference_towards(Vector3d::Zero()));
  EXPECT_EQ(source_after(choice, at_reference, kPatience), EstimateSource::reference);
  EXPECT_EQ(source_after(choice, at_reference, kPatience), EstimateSource::flow);
  EXPECT_NEAR(choice.step(at_reference).initial_from_camera.translation.norm(), 0, 1e-12);
}

// Directions and translations of a later reference frame count from its pose.
TEST(EstimateChoice, ComparesFlowWithLaterReferenceFrame) {
  EstimateChoice choice({});
  EstimatePair pair = pair_of(flow_at(2 * kForward + 0.5 * kLeft, 30), {});
  pair.initial_from_reference = {so3_exp({0, 0, 30 * kDegree}), 2 * kForward};
  pair.reference = reference_towards(so3_exp({0, 0, -30 * kDegree}) * kLeft);
  EXPECT_EQ(source_after(choice, pair, 20), EstimateSource::flow);
  pair.reference = reference_towards(kLeft);
  EXPECT_EQ(source_after(choice, pair, kPatience), EstimateSource::reference);
}

// The position continues from the last decision, not from the flow's prediction.
TEST(EstimateChoice, ResumesInterruptedFlowWithoutJump) {
  EstimateChoice choice({});
  const EstimatePair before = pair_of(flow_at(kForward), reference_towards(kForward));
  const Vector3d position = choice.step(before).initial_from_camera.translation;
  MotionEstimate diverged = flow_at(kForward + 3 * kLeft);
  EXPECT_EQ(choice.step(pair_of(lost(diverged), reference_towards(kForward))).source,
            EstimateSource::reference);
  EXPECT_TRUE(choice.step(pair_of(diverged, lost(reference_towards(kForward))))
                  .initial_from_camera.translation.isApprox(position));
  diverged.displacement_in_reference += 0.1 * kForward;
  EXPECT_TRUE(choice.step(pair_of(diverged, lost(reference_towards(kForward))))
                  .initial_from_camera.translation.isApprox(1.1 * kForward));
}

TEST(EstimateChoice, MotionDuringAnInterruptionIsUncertain) {
  EstimateChoice choice({});
  (void)choice.step(pair_of(flow_at(kForward), reference_towards(kForward)));
  const MotionEstimate later = flow_at(1.5 * kForward);
  (void)choice.step(pair_of(lost(later), reference_towards(kForward)));
  const EstimateDecision resumed = choice.step(pair_of(later, lost(reference_towards(kForward))));
  EXPECT_EQ(resumed.source, EstimateSource::flow);
  EXPECT_NEAR(resumed.correction_covariance(0, 0), 0.5 * 0.5, 1e-12);
}

TEST(EstimateChoice, TreatsNonFiniteEstimateAsLost) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EstimateChoice choice({});
  const EstimateDecision by_reference =
      choice.step(pair_of(flow_at({nan, 0, 0}), reference_towards(kForward, 1)));
  EXPECT_EQ(by_reference.source, EstimateSource::reference);
  EXPECT_TRUE(by_reference.initial_from_camera.translation.allFinite());
  const EstimateDecision by_flow =
      choice.step(pair_of(flow_at(kForward), reference_towards({nan, nan, nan})));
  EXPECT_EQ(by_flow.source, EstimateSource::flow);
  EXPECT_TRUE(by_flow.initial_from_camera.translation.allFinite());
}

}  // namespace
}  // namespace stillkite
