#include "stabilization/estimate_choice.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using Eigen::Vector3d;

const int kPatience = EstimateChoiceConfig{}.patience_frames;
constexpr double kHeight_m = 3;

MotionEstimate flow_at(const Vector3d& way_m, double yaw_deg = 0) {
  MotionEstimate motion;
  motion.source = EstimateSource::flow;
  motion.status = EstimateStatus::ok;
  motion.reference_from_camera = so3_exp({0, 0, yaw_deg * kDegree});
  motion.rotation_covariance = 1e-6 * Eigen::Matrix3d::Identity();
  motion.displacement_kind = DisplacementKind::metric;
  motion.displacement_in_reference = way_m;
  motion.displacement_covariance = 1e-6 * Eigen::Matrix3d::Identity();
  return motion;
}

MotionEstimate reference_towards(const Vector3d& way, double yaw_deg = 0) {
  MotionEstimate motion = flow_at(way.stableNormalized(), yaw_deg);
  motion.source = EstimateSource::reference;
  motion.displacement_kind = way.isZero() ? DisplacementKind::zero : DisplacementKind::direction;
  return motion;
}

MotionEstimate lost(MotionEstimate motion) {
  motion.status = EstimateStatus::lost;
  return motion;
}

EstimatePair seen(const MotionEstimate& flow, const MotionEstimate& reference,
                  std::optional<double> relief_ratio = 0, std::optional<double> misfit_ratio = {}) {
  return {.flow = flow,
          .reference = reference,
          .start_from_reference = {},
          .relief_ratio = relief_ratio,
          .misfit_ratio = misfit_ratio,
          .start_height = kHeight_m};
}

// The source after that many frames of the same.
EstimateSource source_after(EstimateChoice& choice, const EstimatePair& estimates, int frames) {
  EstimateDecision decision;
  for (int i = 0; i < frames; ++i) decision = choice.step(estimates);
  return decision.source;
}

const Vector3d kAhead(1, 0, 0);
const Vector3d kAside(0, 1, 0);

TEST(EstimateChoice, TakesTheFlowWhileTheyAgree) {
  EstimateChoice choice({});
  const EstimatePair agreeing = seen(flow_at(kAhead, 2), reference_towards(kAhead, 2.5));
  EXPECT_EQ(source_after(choice, agreeing, 20), EstimateSource::flow);
  const EstimateDecision decision = choice.step(agreeing);
  EXPECT_TRUE(decision.start_from_camera.translation.isApprox(kAhead));
  EXPECT_NEAR(so3_log(decision.start_from_camera.rotation).z(), 2 * kDegree, 1e-12);
  EXPECT_TRUE(decision.correction_covariance.isZero());
}

// One after the other: rotation, direction, the opposite way, a way where there is none, relief.
TEST(EstimateChoice, TakesTheReferenceOnceTheyHaveDisagreedForSomeFrames) {
  const MotionEstimate ahead = flow_at(kAhead);
  for (const EstimatePair& pair :
       {seen(flow_at(kAhead, 4), reference_towards(kAhead)),
        seen(ahead, reference_towards(kAhead + 0.3 * kAside)),
        seen(ahead, reference_towards(-kAhead)), seen(ahead, reference_towards(Vector3d::Zero())),
        seen(ahead, reference_towards(kAhead), 0.5)}) {
    EstimateChoice choice({});
    EXPECT_EQ(source_after(choice, pair, kPatience - 1), EstimateSource::flow);
    const EstimateDecision decision = choice.step(pair);
    EXPECT_EQ(decision.source, EstimateSource::reference);
    EXPECT_TRUE(decision.start_from_camera.rotation.isApprox(pair.reference.reference_from_camera));
  }
}

TEST(EstimateChoice, GivesEitherTheRoomThatItsCovarianceClaims) {
  MotionEstimate vague = reference_towards(kAhead + 0.3 * kAside, 4);
  vague.rotation_covariance = 0.04 * 0.04 * Eigen::Matrix3d::Identity();
  vague.displacement_covariance = 0.1 * 0.1 * Eigen::Matrix3d::Identity();
  EstimateChoice choice({});
  EXPECT_EQ(source_after(choice, seen(flow_at(kAhead), vague), 20), EstimateSource::flow);
}

TEST(EstimateChoice, KnowsOfReliefUntilParallaxTellsOtherwise) {
  EstimateChoice choice({});
  const MotionEstimate flow = flow_at(kAhead);
  const MotionEstimate reference = reference_towards(kAhead);
  EXPECT_EQ(source_after(choice, seen(flow, reference, 0.5), 20), EstimateSource::reference);
  EXPECT_EQ(source_after(choice, seen(flow, reference, {}), 20), EstimateSource::reference);
  EXPECT_EQ(source_after(choice, seen(flow, reference, 0.05), kPatience - 1),
            EstimateSource::reference);
  EXPECT_EQ(source_after(choice, seen(flow, reference, 0.05), 1), EstimateSource::flow);
}

// As long as parallax has told nothing the flow's metres may be those of any ground.
TEST(EstimateChoice, DoubtsTheFlowsWayUntilFlatGroundHasShown) {
  EstimateChoice choice({});
  const auto unproven_way = [&](const Vector3d& way, std::optional<double> relief_ratio) {
    const EstimatePair pair = seen(flow_at(way), reference_towards(way), relief_ratio);
    return choice.step(pair).unproven_way;
  };
  EXPECT_DOUBLE_EQ(unproven_way(0.2 * kAhead, {}), 0.2);
  EXPECT_DOUBLE_EQ(unproven_way(0.1 * kAside, {}), 0.2);  // what went wrong on the way stays
  EXPECT_EQ(unproven_way(0.3 * kAhead, 0.05), 0);
  EXPECT_EQ(unproven_way(0.1 * kAhead, {}), 0);
  EXPECT_DOUBLE_EQ(unproven_way(0.4 * kAhead, 0.5), 0.3);  // it stays chosen for some frames
  EstimateChoice turned({});
  const EstimatePair pair = seen(flow_at(0.1 * kAhead, 3), reference_towards(kAhead), {});
  EXPECT_NEAR(turned.step(pair).unproven_way, kHeight_m * 3 * kDegree, 1e-12);
}

// A reference whose pose is a false one, on a plane an essential matrix often is.
TEST(EstimateChoice, TakesTheFlowWhileTheFeaturesAreWhereItTakesThem) {
  EstimateChoice choice({});
  const EstimatePair false_pose = seen(flow_at(kAhead), reference_towards(kAside, 10), 0.9, 0.05);
  EXPECT_EQ(source_after(choice, false_pose, 20), EstimateSource::flow);
  EXPECT_TRUE(choice.step(false_pose).home_from_flow.translation.isZero());
  const EstimatePair true_pose = seen(flow_at(kAhead), reference_towards(kAside, 10), 0.9, 0.9);
  EXPECT_EQ(source_after(choice, true_pose, 20), EstimateSource::reference);
}

TEST(EstimateChoice, TakesNoFlowInADepthThatHasShown) {
  EstimateChoice choice({});
  const MotionEstimate flow = flow_at(kAhead);
  const MotionEstimate reference = reference_towards(kAhead);
  EXPECT_EQ(source_after(choice, seen(flow, reference, 0.5), 20), EstimateSource::reference);
  EXPECT_EQ(source_after(choice, seen(flow, lost(reference), {}), 20), EstimateSource::reference);
  // until the features are where it takes them
  EXPECT_EQ(source_after(choice, seen(flow, lost(reference), {}, 0.1), 1), EstimateSource::flow);
}

TEST(EstimateChoice, DoesNotChatter) {
  EstimateChoice choice({});
  for (int i = 0; i < 100; ++i) {
    const double relief_ratio = i % kPatience == 0 ? 0 : 1;
    EXPECT_EQ(choice.step(seen(flow_at(kAhead), reference_towards(kAhead), relief_ratio)).source,
              EstimateSource::flow);
  }
}

TEST(EstimateChoice, LeavesAtOnceWhatIsLost) {
  const MotionEstimate flow = flow_at(kAhead);
  const MotionEstimate reference = reference_towards(kAhead);
  EstimateChoice choice({});
  EXPECT_EQ(choice.step(seen(lost(flow), reference)).source, EstimateSource::reference);
  EXPECT_EQ(choice.step(seen(flow, reference)).source, EstimateSource::reference);
  MotionEstimate gated = reference;
  gated.status = EstimateStatus::gated;
  EXPECT_EQ(choice.step(seen(flow, gated)).source, EstimateSource::flow);
}

TEST(EstimateChoice, StaysWhereItWasWhenBothAreLost) {
  for (const bool flow_first : {true, false}) {
    EstimateChoice choice({});
    const MotionEstimate flow = flow_at(kAhead);
    const MotionEstimate reference = reference_towards(kAhead, 1);
    const EstimateDecision before = flow_first ? choice.step(seen(flow, lost(reference)))
                                               : choice.step(seen(lost(flow), reference));
    const EstimateDecision blind = choice.step(seen(lost(flow), lost(reference)));
    EXPECT_EQ(blind.source, flow_first ? EstimateSource::flow : EstimateSource::reference);
    EXPECT_TRUE(blind.start_from_camera.rotation.isApprox(before.start_from_camera.rotation));
    EXPECT_TRUE(blind.start_from_camera.translation.isApprox(before.start_from_camera.translation));
  }
}

// The reference holds the truth while the flow has drifted aside, along and in heading.
TEST(EstimateChoice, TheFlowGoesOnWhereTheReferenceStopped) {
  EstimateChoice choice({});
  const MotionEstimate reference = reference_towards(kAhead, 5);
  const MotionEstimate drifted = flow_at(1.2 * kAhead + 0.4 * kAside, 9);
  EXPECT_EQ(source_after(choice, seen(drifted, reference), kPatience), EstimateSource::reference);
  const EstimateDecision before = choice.step(seen(drifted, reference));
  // d d^T c with d ahead
  EXPECT_TRUE(before.start_from_camera.translation.isApprox(1.2 * kAhead, 1e-9));
  // the flow has the camera 0.1 m further along its own heading, 4 degrees off
  const Vector3d further = 0.1 * (so3_exp({0, 0, 9 * kDegree}) * kAhead);
  const MotionEstimate next = flow_at(drifted.displacement_in_reference + further, 9);
  const EstimateDecision after = choice.step(seen(next, lost(reference)));
  EXPECT_EQ(after.source, EstimateSource::flow);
  EXPECT_NEAR(so3_log(after.start_from_camera.rotation).z(), 5 * kDegree, 1e-9);
  const Vector3d along_true_heading = 0.1 * (so3_exp({0, 0, 5 * kDegree}) * kAhead);
  EXPECT_TRUE(
      after.start_from_camera.translation.isApprox(1.2 * kAhead + along_true_heading, 1e-9));
  // what was wrong across may be as wrong along
  EXPECT_GT(after.correction_covariance(0, 0), 0.1);
}

TEST(EstimateChoice, AtHomeAgainTheFlowHasNoWayBehindIt) {
  EstimateChoice choice({});
  const MotionEstimate drifted = flow_at(0.5 * kAside, 0);
  const EstimatePair home = seen(drifted, reference_towards(Vector3d::Zero()));
  EXPECT_EQ(source_after(choice, home, kPatience), EstimateSource::reference);
  EXPECT_EQ(source_after(choice, home, kPatience), EstimateSource::flow);
  EXPECT_NEAR(choice.step(home).start_from_camera.translation.norm(), 0, 1e-12);
}

// From a later reference frame directions and ways count from there.
TEST(EstimateChoice, ALaterReferenceIsAsGoodAsTheFirst) {
  EstimateChoice choice({});
  EstimatePair pair = seen(flow_at(2 * kAhead + 0.5 * kAside, 30), {});
  pair.start_from_reference = {so3_exp({0, 0, 30 * kDegree}), 2 * kAhead};
  pair.reference = reference_towards(so3_exp({0, 0, -30 * kDegree}) * kAside);
  EXPECT_EQ(source_after(choice, pair, 20), EstimateSource::flow);
  pair.reference = reference_towards(kAside);
  EXPECT_EQ(source_after(choice, pair, kPatience), EstimateSource::reference);
}

// The place stays where the answers had it, whatever the flow took the camera for while blind.
TEST(EstimateChoice, AnInterruptedFlowIsTakenUpWithoutAJump) {
  EstimateChoice choice({});
  const EstimatePair before = seen(flow_at(kAhead), reference_towards(kAhead));
  const Vector3d place = choice.step(before).start_from_camera.translation;
  MotionEstimate astray = flow_at(kAhead + 3 * kAside);
  EXPECT_EQ(choice.step(seen(lost(astray), reference_towards(kAhead))).source,
            EstimateSource::reference);
  EXPECT_TRUE(choice.step(seen(astray, lost(reference_towards(kAhead))))
                  .start_from_camera.translation.isApprox(place));
  astray.displacement_in_reference += 0.1 * kAhead;
  EXPECT_TRUE(choice.step(seen(astray, lost(reference_towards(kAhead))))
                  .start_from_camera.translation.isApprox(1.1 * kAhead));
}

TEST(EstimateChoice, WhatIsNoNumberIsLost) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EstimateChoice choice({});
  const EstimateDecision one =
      choice.step(seen(flow_at({nan, 0, 0}), reference_towards(kAhead, 1)));
  EXPECT_EQ(one.source, EstimateSource::reference);
  EXPECT_TRUE(one.start_from_camera.translation.allFinite());
  const EstimateDecision other =
      choice.step(seen(flow_at(kAhead), reference_towards({nan, nan, nan})));
  EXPECT_EQ(other.source, EstimateSource::flow);
  EXPECT_TRUE(other.start_from_camera.translation.allFinite());
}

}  // namespace
}  // namespace stillkite
