#include "simulation/hover/hover_trial.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "evaluation/trial_statistics.hpp"
#include "tests/simulation/hover/small_hover_camera.hpp"

namespace stillkite {
namespace {

// Short trial at low resolution; amplitude of the station path 0.8 m.
HoverConfig short_trials() {
  HoverConfig config;
  config.plant.camera = small_hover_camera(400, 10);
  config.plant.station.level_reach_m = 0.8;
  return config;
}

const HoverWorld& world() {
  static const HoverWorld made = make_hover_world(short_trials());
  return made;
}

double mean_displacement_m(const TrialRecord& record) {
  std::vector<double> d;
  d.reserve(record.samples.size());
  for (const TrialSample& sample : record.samples) {
    d.push_back(sample.displacement_in_world_m.dot(paper_axis_in_world(record.trial.axis)));
  }
  return signed_statistics(d)->mean;
}

TEST(HoverTrial, DroneFollowsStationWithoutStabilization) {
  const TrialRecord record = fly_trial(short_trials(), world(), {.stabilized = false});
  ASSERT_GT(record.samples.size(), 80U);
  for (const TrialSample& sample : record.samples) {
    const Eigen::Vector3d station_m =
        sample.station_in_world_m - record.samples[0].station_in_world_m;
    EXPECT_LT((sample.displacement_in_world_m - station_m).norm(), 1e-6);
    EXPECT_EQ(sample.action, HoldAction::hold);
  }
}

// The drone follows its station as without an estimator; the displacement is estimated.
TEST(HoverTrial, PassiveEstimatorDoesNotAffectFlight) {
  HoverConfig config = short_trials();
  config.estimator.policy = Policy::fused;
  const Trial off{.stabilized = false, .seed = 3};
  const TrialRecord alone = fly_trial(config, world(), off);
  EXPECT_TRUE(alone.estimate_errors.empty());
  config.trials.estimate_off = true;
  const TrialRecord observed = fly_trial(config, world(), off);
  ASSERT_EQ(observed.samples.size(), alone.samples.size());
  for (std::size_t i = 0; i < alone.samples.size(); ++i) {
    EXPECT_EQ(observed.samples[i].displacement_in_world_m,
              alone.samples[i].displacement_in_world_m);
    EXPECT_EQ(observed.samples[i].command.length_rate_m_s, 0);
  }
  ASSERT_GT(observed.estimate_errors.size(), alone.samples.size() - 4);
  double max_error_m = 0;
  for (const EstimateError& error : observed.estimate_errors) {
    max_error_m = std::max(max_error_m, error.position_error_m.value_or(0));
  }
  EXPECT_GT(max_error_m, 0);
  EXPECT_LT(max_error_m, 0.2);
}

TEST(HoverTrial, StabilizationReducesDisplacementDeterministically) {
  const HoverConfig config = short_trials();
  const TrialRecord off = fly_trial(config, world(), {.stabilized = false});
  const TrialRecord on = fly_trial(config, world(), {.seed = 3});
  EXPECT_LT(mean_displacement_m(on), 0.5 * mean_displacement_m(off));
  const TrialRecord again = fly_trial(config, world(), {.seed = 3});
  ASSERT_EQ(on.samples.size(), again.samples.size());
  for (std::size_t i = 0; i < on.samples.size(); ++i) {
    EXPECT_EQ(on.samples[i].displacement_in_world_m, again.samples[i].displacement_in_world_m);
  }
}

// Without control the yaw is the sum of the kicks.
TEST(HoverTrial, RecordContainsYawKicks) {
  HoverConfig config = short_trials();
  const TrialRecord quiet = fly_trial(config, world(), {.stabilized = false, .seed = 3});
  EXPECT_TRUE(quiet.kicks.empty());
  EXPECT_EQ(quiet.samples.back().yaw_rad, 0);
  config.plant.yaw_kicks = YawKickConfig{.every_s = 2};
  const TrialRecord record = fly_trial(config, world(), {.stabilized = false, .seed = 3});
  ASSERT_GE(record.kicks.size(), 2U);
  double sum_rad = 0;
  for (const YawKick& kick : record.kicks) sum_rad += kick.angle_rad;
  EXPECT_NEAR(record.samples.back().yaw_rad, sum_rad, 1e-9);
}

TEST(HoverTrial, ObserverReceivesImagesInOrder) {
  HoverConfig config = short_trials();
  config.cycle = {.period_s = 0.2, .compute_s = 0.1};
  int received = 0;
  Timestamp last{-1};
  const TrialRecord record =
      fly_trial(config, world(), {},
                [&](const Frame& frame, const NavigationEstimate& estimate, const HoldDecision&) {
                  EXPECT_GT(frame.stamp, last);
                  EXPECT_EQ(estimate.stamp, frame.stamp);
                  last = frame.stamp;
                  ++received;
                });
  EXPECT_NEAR(received, record.samples.back().t_s / 0.2, 2);
}

TEST(HoverTrial, DefaultsToPapersTwelveTrials) {
  const std::vector<Trial> trials = make_trials({});
  ASSERT_EQ(trials.size(), 12U);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(trials[i].axis, static_cast<PaperAxis>(i / 4));
    EXPECT_EQ(trials[i].stabilized, i % 4 < 3);
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(trials[i].seed, trials[k].seed);
  }
}

}  // namespace
}  // namespace stillkite
