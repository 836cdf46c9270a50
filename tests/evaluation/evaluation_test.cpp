#include "evaluation/evaluation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/frame_error.hpp"

namespace stillkite {
namespace {

constexpr int kFrames = 101;

/// 100 m along x in 10 s, 1 m per frame, camera looking straight down.
Truth straight_flight() {
  Truth truth;
  for (int i = 0; i < kFrames; ++i) {
    truth.poses.push_back(
        {.stamp = from_seconds(0.1 * i), .world_from_body = {.translation = {1.0 * i, 0, 10}}});
  }
  return truth;
}

const RigidTransform kNadir{.rotation = Eigen::Quaterniond(0, 1, 0, 0)};

TEST(Evaluate, TruthHasZeroError) {
  const Truth truth = straight_flight();
  const Evaluation result = evaluate(evaluated_motions(truth.poses), truth);
  EXPECT_EQ(result.matched, kFrames);
  EXPECT_NEAR(*result.path_length_m, 100, 1e-9);
  EXPECT_EQ(result.trajectory->position->rmse_m, 0);
  EXPECT_EQ(*result.drift_percent, 0);
  EXPECT_EQ(result.velocity->samples, kFrames - 1);
  EXPECT_EQ(result.velocity->rmse.norm(), 0);
  EXPECT_FALSE(result.velocity->correlation[1]);
  EXPECT_FALSE(result.nees.position);
}

TEST(Evaluate, ReportsDriftRelativeToPathLength) {
  const Truth truth = straight_flight();
  std::vector<StampedPose> poses = truth.poses;
  for (StampedPose& pose : poses) {
    pose.world_from_body.translation.y() += 0.003 * pose.world_from_body.translation.x();
    pose.world_from_body.translation.z() += 0.004 * pose.world_from_body.translation.x();
  }
  const Evaluation result = evaluate(evaluated_motions(poses), truth);
  EXPECT_NEAR(*result.drift_percent, 0.5, 1e-9);
  EXPECT_NEAR(result.trajectory->position->end->horizontal_m, 0.3, 1e-9);
  EXPECT_NEAR(result.trajectory->position->end->vertical_m, 0.4, 1e-9);
  EXPECT_NEAR(result.velocity->rmse.y(), 0.03, 1e-9);
  EXPECT_NEAR(result.per_tenth->translation_rmse_m, 0.05, 1e-9);
}

// Down-looking camera: x is kept, y and z change sign. Velocity error of 0.2 m/s along x.
TEST(Evaluate, ComparesVelocitiesInTheCameraFrame) {
  const Truth truth = straight_flight();
  std::vector<EvaluatedMotion> estimates = evaluated_motions(truth.poses);
  for (EvaluatedMotion& estimate : estimates) {
    estimate.twist_in_camera = Twist{.velocity_m_s = {10.2, 0, 0}};
  }
  const Evaluation result = evaluate(estimates, truth, {.body_from_camera = kNadir});
  EXPECT_NEAR(result.velocity->rmse.x(), 0.2, 1e-9);
  EXPECT_NEAR(result.velocity->median_abs.x(), 0.2, 1e-9);
  EXPECT_NEAR(result.velocity->rmse.y(), 0, 1e-9);
  EXPECT_NEAR(result.angular_rate->rmse.norm(), 0, 1e-9);
}

TEST(Evaluate, PrefersMeasuredTrueVelocities) {
  Truth truth = straight_flight();
  std::vector<EvaluatedMotion> estimates = evaluated_motions(truth.poses);
  for (std::size_t i = 1; i < truth.poses.size(); ++i) {
    const double v = std::sin(0.3 * static_cast<double>(i));
    truth.twists_in_camera.push_back({truth.poses[i].stamp, {.velocity_m_s = {v, 0, 0}}});
    estimates[i].twist_in_camera = Twist{.velocity_m_s = {2 * v + 1, 0, 0}};
  }
  const Evaluation result = evaluate(estimates, truth);
  EXPECT_EQ(result.velocity->samples, kFrames - 1);
  EXPECT_NEAR(*result.velocity->correlation[0], 1, 1e-9);
}

TEST(Evaluate, DoesNotDifferenceAcrossAGap) {
  Truth truth = straight_flight();
  const auto estimates = evaluated_motions(truth.poses);
  truth.poses.erase(truth.poses.begin() + 50);
  const Evaluation result = evaluate(estimates, truth);
  EXPECT_EQ(result.matched, kFrames - 1);
  EXPECT_EQ(result.velocity->samples, kFrames - 3);
}

TEST(Evaluate, ReportsNees) {
  const Truth truth = straight_flight();
  std::vector<EvaluatedMotion> estimates = evaluated_motions(truth.poses);
  for (EvaluatedMotion& estimate : estimates) {
    estimate.world_from_body.translation += Eigen::Vector3d(0.1, 0.1, 0.1);
    estimate.world_from_body.rotation = so3_exp({0, 0, 0.02});
    estimate.pose_covariance = 0.01 * Matrix6d::Identity();
    estimate.twist_in_camera = Twist{.velocity_m_s = {10.0, 0.2, 0}};
    estimate.twist_covariance = 0.01 * Matrix6d::Identity();
  }
  const Evaluation result = evaluate(estimates, truth);
  EXPECT_NEAR(result.nees.position->mean, 3, 1e-9);
  EXPECT_NEAR(result.nees.attitude->mean, 0.04, 1e-9);
  EXPECT_NEAR(result.nees.velocity->mean, 4, 1e-9);
  EXPECT_NEAR(result.nees.angular_rate->mean, 0, 1e-9);
}

TEST(Evaluate, ScalesVelocitiesWithSim3) {
  Truth truth;
  std::vector<EvaluatedMotion> estimates;
  for (int i = 0; i < 60; ++i) {
    const double s = 0.1 * i;
    const RigidTransform pose{.translation = {std::cos(s), std::sin(s), 2 + 0.1 * s}};
    truth.poses.push_back({from_seconds(s), pose});
    RigidTransform small = pose;
    small.translation *= 0.5;
    estimates.push_back({.stamp = from_seconds(s), .world_from_body = small});
  }
  const Evaluation result = evaluate(estimates, truth, {.alignment = Alignment::sim3});
  EXPECT_NEAR(result.alignment->scale, 2, 1e-9);
  EXPECT_NEAR(result.trajectory->position->rmse_m, 0, 1e-9);
  EXPECT_NEAR(result.velocity->rmse.norm(), 0, 1e-9);
}

// Exact estimate of a flight with 0.5 rad/s of yaw; the truth has no attitude.
TEST(Evaluate, DoesNotJudgeAttitudeWithATruthOfPositions) {
  std::vector<EvaluatedMotion> estimates;
  Truth truth;
  truth.has_attitude = false;
  for (const StampedPose& pose : straight_flight().poses) {
    truth.poses.push_back(pose);
    estimates.push_back({.stamp = pose.stamp,
                         .world_from_body = {so3_exp({0, 0, 0.5 * to_seconds(pose.stamp)}),
                                             pose.world_from_body.translation},
                         .pose_covariance = Matrix6d::Identity(),
                         .twist_covariance = Matrix6d::Identity()});
  }
  const Evaluation result = evaluate(estimates, truth, {.body_from_camera = kNadir});
  EXPECT_EQ(result.matched, kFrames);
  EXPECT_NEAR(result.trajectory->position->rmse_m, 0, 1e-12);
  EXPECT_NEAR(result.velocity->rmse.norm(), 0, 1e-9);
  EXPECT_NEAR(result.per_metre->translation_rmse_m, 0, 1e-9);
  EXPECT_TRUE(result.nees.position && result.nees.velocity);
  EXPECT_FALSE(result.trajectory->attitude);
  EXPECT_FALSE(result.angular_rate);
  EXPECT_FALSE(result.per_metre->rotation_rmse_rad);
  EXPECT_FALSE(result.nees.attitude);
  EXPECT_FALSE(result.nees.angular_rate);
}

// A constant attitude, other than the identity, of a turning vehicle or of one that flies straight.
TEST(Evaluate, RecognizesAnAttitudeThatIsFilledIn) {
  for (const bool turns : {true, false}) {
    std::vector<StampedPose> truth;
    std::vector<EvaluatedMotion> estimates;
    for (int i = 0; i < kFrames; ++i) {
      const Timestamp stamp = from_seconds(0.1 * i);
      const Eigen::Quaterniond constant = so3_exp({0, 0, 1});
      truth.push_back({stamp, {constant, Eigen::Vector3d::Zero()}});
      const double yaw_rad = (turns ? 0.05 : 0.002) * i;
      estimates.push_back(
          {.stamp = stamp, .world_from_body = {so3_exp({0, 0, yaw_rad}), Eigen::Vector3d::Zero()}});
    }
    EXPECT_EQ(contradicts_constant_attitude(estimates, truth), turns);
    truth.back().world_from_body.rotation = so3_exp({0, 0, 1.001});
    EXPECT_FALSE(contradicts_constant_attitude(estimates, truth));
  }
}

TEST(Evaluate, DoesNotJudgeAttitudeOfAnEstimateOfPositions) {
  Truth truth = straight_flight();
  const auto estimates = evaluated_motions(truth.poses, false);
  for (StampedPose& pose : truth.poses) {
    pose.world_from_body.rotation = so3_exp({0, 0, 0.5 * to_seconds(pose.stamp)});
  }
  for (const Alignment alignment : {Alignment::none, Alignment::origin}) {
    const Evaluation result = evaluate(estimates, truth, {.alignment = alignment});
    EXPECT_NEAR(result.trajectory->position->rmse_m, 0, 1e-9);
    EXPECT_NEAR(result.velocity->rmse.norm(), 0, 1e-9);
    EXPECT_FALSE(result.trajectory->attitude);
    EXPECT_FALSE(result.angular_rate);
  }
}

// Velocity error of 0.2 m/s along the camera's x axis; the body has a yaw of 90 degrees.
TEST(Evaluate, JudgesVelocityAloneWithATruthOfVelocities) {
  std::vector<EvaluatedMotion> estimates;
  Truth truth;
  for (int i = 0; i < kFrames; ++i) {
    truth.velocities.push_back({from_seconds(0.1 * i - 0.05), {10, 0, 0}});
    estimates.push_back({.stamp = from_seconds(0.1 * i),
                         .world_from_body = {.rotation = so3_exp({0, 0, M_PI / 2})},
                         .twist_in_camera = Twist{.velocity_m_s = {0.2, -10, 0}}});
  }
  const Evaluation result = evaluate(estimates, truth);
  EXPECT_EQ(result.matched, kFrames - 1);
  EXPECT_NEAR(result.velocity->rmse.x(), 0.2, 1e-9);
  EXPECT_NEAR(result.velocity->rmse.y(), 0, 1e-9);
  EXPECT_FALSE(result.trajectory);
  EXPECT_FALSE(result.path_length_m);
  EXPECT_FALSE(result.angular_rate);
  EXPECT_NEAR(mean_error(frame_errors(estimates, truth), FrameFigure::velocity).value(), 0.2, 1e-9);
}

// v = (t, 0, 0): linear interpolation is exact. Rows at the stamps of the frames, and at lower
// rates.
TEST(Evaluate, InterpolatesATruthOfVelocitiesAndUsesEachRowOnce) {
  constexpr int kRate_hz = 30, kSeconds = 4;
  std::vector<EvaluatedMotion> estimates;
  for (int i = 0; i <= kRate_hz * kSeconds; ++i) {
    const double t_s = static_cast<double>(i) / kRate_hz;
    estimates.push_back({.stamp = from_seconds(t_s),
                         .world_from_body = {},
                         .twist_in_camera = Twist{.velocity_m_s = {t_s - 0.5 / kRate_hz, 0, 0}}});
  }
  for (const int rate_hz : {30, 10, 5, 100}) {
    Truth truth;
    for (int i = 0; i <= rate_hz * kSeconds; ++i) {
      const double t_s = static_cast<double>(i) / rate_hz;
      truth.velocities.push_back({from_seconds(t_s), {t_s, 0, 0}});
    }
    const Evaluation result = evaluate(estimates, truth);
    EXPECT_NEAR(result.matched, std::min(rate_hz, kRate_hz) * kSeconds, 1) << rate_hz;
    EXPECT_LE(result.matched, std::ssize(truth.velocities)) << rate_hz;
    EXPECT_NEAR(result.velocity->rmse.norm(), 0, 1e-8) << rate_hz;
  }
}

TEST(Evaluate, DoesNotInterpolateATruthOfVelocitiesOverAGap) {
  std::vector<EvaluatedMotion> estimates;
  Truth truth;
  for (int i = 0; i < kFrames; ++i) {
    const bool is_gap = i > 50 && i < 60;
    if (!is_gap) truth.velocities.push_back({from_seconds(0.1 * i), {10, 0, 0}});
    estimates.push_back({.stamp = from_seconds(0.1 * i),
                         .world_from_body = {},
                         .twist_in_camera = Twist{.velocity_m_s = {10, 0, 0}}});
  }
  EXPECT_EQ(evaluate(estimates, truth).matched, kFrames - 1 - 10);
}

// A yaw error of 0.01 rad of its own standard deviation turns 10 m/s by 0.1 m/s.
TEST(Evaluate, AttitudeCovarianceExplainsTheRotationOfATrueVelocity) {
  std::vector<EvaluatedMotion> estimates;
  Truth truth;
  for (int i = 0; i < kFrames; ++i) {
    truth.velocities.push_back({from_seconds(0.1 * i - 0.05), {10, 0, 0}});
    estimates.push_back({.stamp = from_seconds(0.1 * i),
                         .world_from_body = {.rotation = so3_exp({0, 0, 0.01})},
                         .twist_in_camera = Twist{.velocity_m_s = {10, 0, 0}},
                         .pose_covariance = 1e-4 * Matrix6d::Identity(),
                         .twist_covariance = 1e-4 * Matrix6d::Identity()});
  }
  EXPECT_NEAR(evaluate(estimates, truth).nees.velocity->mean, 1, 1e-2);
}

// Errors of 0.1 m per axis; truth and estimate have the same sigma of 0.1 m.
TEST(Evaluate, ExpectedSpreadIncludesTheErrorOfTheTruth) {
  Truth truth = straight_flight();
  std::vector<EvaluatedMotion> estimates = evaluated_motions(truth.poses);
  for (EvaluatedMotion& estimate : estimates) {
    estimate.world_from_body.translation += Eigen::Vector3d(0.1, 0.1, 0.1);
    estimate.pose_covariance = 0.01 * Matrix6d::Identity();
  }
  EXPECT_NEAR(evaluate(estimates, truth).nees.position->mean, 3, 1e-9);
  EXPECT_NEAR(*evaluate(estimates, truth).nees.position->sigma_over_rms, 1, 1e-9);
  truth.sigma.position_m = 0.1;
  EXPECT_NEAR(evaluate(estimates, truth).nees.position->mean, 1.5, 1e-9);
  EXPECT_NEAR(*evaluate(estimates, truth).nees.position->sigma_over_rms, std::sqrt(2), 1e-9);
}

// Scale error of 2 % over 100 m: 0.02 m per metre; RMSE = 2 m sqrt(201 / 600).
TEST(Evaluate, ReportsErrorsRelativeToMetreAndPath) {
  const Truth truth = straight_flight();
  std::vector<StampedPose> poses = truth.poses;
  for (StampedPose& pose : poses) pose.world_from_body.translation.x() *= 1.02;
  const Evaluation result = evaluate(evaluated_motions(poses), truth);
  EXPECT_EQ(result.per_metre->count, 100);
  EXPECT_NEAR(result.per_metre->translation_rmse_m, 0.02, 1e-9);
  EXPECT_NEAR(*result.rmse_percent, 2 * std::sqrt(201.0 / 600), 1e-9);
}

// The first second has no metric scale: lengths in initial heights of 10 m.
TEST(Evaluate, ExcludesLengthsOfNonMetricFrames) {
  const Truth truth = straight_flight();
  std::vector<NavigationEstimate> rows;
  for (const StampedPose& pose : truth.poses) {
    rows.push_back({.stamp = pose.stamp,
                    .verdict = Verdict::ok,
                    .world_from_body = pose.world_from_body,
                    .twist_in_camera = {.velocity_m_s = {10, 0, 0}},
                    .scale = ScaleSource::range});
    rows.back().world_from_body.translation.y() += 0.3;
  }
  for (std::size_t i = 0; i < 10; ++i) {
    rows[i].scale = ScaleSource::none;
    rows[i].world_from_body.translation /= 10;
    rows[i].twist_in_camera.velocity_m_s /= 10;
  }
  Evaluation result = evaluate(evaluated_motions(rows), truth);
  EXPECT_EQ(result.matched, kFrames);
  EXPECT_NEAR(result.trajectory->position->rmse_m, 0.3, 1e-9);
  EXPECT_NEAR(result.drift_percent.value(), 0.3, 1e-9);
  EXPECT_EQ(result.per_frame->count, kFrames - 11);
  EXPECT_EQ(result.velocity->samples, kFrames - 10);
  EXPECT_NEAR(result.velocity->rmse.norm(), 0, 1e-9);

  rows.back().scale = ScaleSource::none;
  result = evaluate(evaluated_motions(rows), truth);
  EXPECT_NEAR(result.trajectory->position->rmse_m, 0.3, 1e-9);
  EXPECT_FALSE(result.trajectory->position->end);
  EXPECT_FALSE(result.drift_percent);
}

TEST(Evaluate, IsEmptyWithoutCommonStamps) {
  const Evaluation result = evaluate(evaluated_motions(straight_flight().poses), {});
  EXPECT_EQ(result.matched, 0);
  EXPECT_FALSE(result.alignment);
  EXPECT_FALSE(result.trajectory);
  EXPECT_FALSE(result.drift_percent);
  EXPECT_FALSE(result.velocity);
}

TEST(EvaluatedMotions, FirstFrameHasNoTwist) {
  const std::vector<NavigationEstimate> estimates{{.verdict = Verdict::first_frame},
                                                  {.verdict = Verdict::frozen}};
  const auto motions = evaluated_motions(estimates);
  EXPECT_FALSE(motions[0].twist_in_camera);
  EXPECT_TRUE(motions[1].twist_in_camera);
}

}  // namespace
}  // namespace stillkite
