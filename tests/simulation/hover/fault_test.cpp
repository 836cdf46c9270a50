#include "simulation/hover/fault.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "simulation/hover/fault_effects.hpp"
#include "simulation/hover/hover_trial.hpp"
#include "tests/simulation/hover/small_hover_camera.hpp"

namespace stillkite {
namespace {

TEST(Fault, LastsFromItsStartForItsDuration) {
  const FaultConfig fault{.kind = FaultKind::picture_dark, .start_s = 4, .duration_s = 2};
  EXPECT_EQ(effect_of(fault, 3.999).light_ratio, 1);
  EXPECT_EQ(effect_of(fault, 4).light_ratio, fault.light_ratio);
  EXPECT_EQ(effect_of(fault, 5.999).light_ratio, fault.light_ratio);
  EXPECT_EQ(effect_of(fault, 6).light_ratio, 1);
  EXPECT_EQ(effect_of(fault, 5).stamps_off_s, 0);
}

TEST(Fault, TheTetherLoosensAndTightensAsFastAsItIsTold) {
  const FaultConfig fault{.kind = FaultKind::tether_slack,
                          .start_s = 4,
                          .duration_s = 2,
                          .loose_tether_m = 0.15,
                          .loosening_m_s = 0.3};
  EXPECT_NEAR(effect_of(fault, 4.1).loose_tether_m, 0.03, 1e-12);
  EXPECT_NEAR(effect_of(fault, 5).loose_tether_m, 0.15, 1e-12);
  EXPECT_NEAR(effect_of(fault, 5.8).loose_tether_m, 0.06, 1e-12);
  EXPECT_EQ(effect_of(fault, 6.1).loose_tether_m, 0);
}

TEST(Fault, AGyroscopesBiasTurnsTheHeadingAndLeavesItTurned) {
  const FaultConfig fault{
      .kind = FaultKind::gyro_bias, .start_s = 4, .duration_s = 2, .gyro_bias_deg_s = 3};
  HoverReadings readings;
  readings.attitude.resize(1);
  readings.attitude[0].world_from_body = to_quaternion({.yaw_rad = 0.1, .pitch_rad = 0.2});
  readings.attitude[0].angular_rate_in_body_rad_s = {0.1, 0.2, 0.3};
  const AttitudeReading during = with_fault(readings, effect_of(fault, 5)).attitude[0];
  EXPECT_NEAR(during.angular_rate_in_body_rad_s.x(), 0.1 + 3 * kDegree, 1e-12);
  EXPECT_NEAR(to_euler(during.world_from_body).yaw_rad, 0.1 + 3 * kDegree, 1e-12);
  EXPECT_NEAR(to_euler(during.world_from_body).pitch_rad, 0.2, 1e-12);
  const AttitudeReading after = with_fault(readings, effect_of(fault, 9)).attitude[0];
  EXPECT_EQ(after.angular_rate_in_body_rad_s.x(), 0.1);
  EXPECT_NEAR(to_euler(after.world_from_body).yaw_rad, 0.1 + 6 * kDegree, 1e-12);
}

TEST(Fault, ACoverHidesTheUpperPartOnly) {
  const cv::Mat light(40, 30, CV_32FC1, cv::Scalar(7));
  const cv::Mat seen = covered(light, 0.75, 1.3);
  EXPECT_EQ(cv::countNonZero(seen.rowRange(0, 30) == 7), 0);
  EXPECT_EQ(cv::countNonZero(seen.rowRange(30, 40) != 7), 0);
}

TEST(Fault, OnlyTheFloorMoves) {
  PatchScene scene;
  scene.patches.push_back({{1, 2, 0}, {3, 0, 0}, {0, -4, 0}, nullptr});
  scene.patches.push_back({{1, 2, 0}, {3, 0, 0}, {0, 0, -4}, nullptr});
  scene.patches.push_back({{1, 2, 4}, {3, 0, 0}, {0, 4, 0}, nullptr});
  const PatchScene moved = with_floor_moved(scene, {0.1, -0.2, 0.3});
  EXPECT_EQ(moved.patches[0].corner_in_world_m, Eigen::Vector3d(1.1, 1.8, 0.3));
  EXPECT_EQ(moved.patches[1].corner_in_world_m, scene.patches[1].corner_in_world_m);
  EXPECT_EQ(moved.patches[2].corner_in_world_m, scene.patches[2].corner_in_world_m);
}

constexpr double kFaultStart_s = 4;
constexpr double kFaultDuration_s = 3;

// The station goes 0.5 m out and back and the other way, at 0.2 m/s but for the turns.
HoverConfig faulty_flight(FaultKind kind) {
  HoverConfig config;
  config.plant.camera = small_hover_camera(400, 20);
  config.plant.station.level_reach_m = 0.5;
  config.plant.fault =
      FaultConfig{.kind = kind, .start_s = kFaultStart_s, .duration_s = kFaultDuration_s};
  config.estimator = {.policy = Policy::fused, .mode = Mode::recommended};
  config.navigator.fusion.height_sigma_ratio = 0.02;
  return config;
}

const HoverWorld& hover_world_of_faults() {
  static const HoverWorld made = make_hover_world(faulty_flight(FaultKind::frozen_video));
  return made;
}

struct FaultyFlight {
  double beyond_station_m = 0;  ///< way since the fault's beginning, less that of the station
  double away_after_5_s_m = 0;  ///< from the start, from 5 s after the fault's end on
  double worst_place_m = 0;     ///< that the estimate was off by, from the fault's beginning on
  double mean_nees_after = 0;   ///< of the images' pose, from the fault's end on
  bool is_loss_told = false;    ///< by a verdict or a reason, while it lasts
  bool is_finite = true;        ///< every command
};

FaultyFlight fly_with(const HoverConfig& config) {
  const TrialRecord record = fly_trial(config, hover_world_of_faults(), {.seed = 3});
  FaultyFlight flown;
  const auto first = std::find_if(record.samples.begin(), record.samples.end(),
                                  [](const TrialSample& s) { return s.t_s >= kFaultStart_s; });
  for (const TrialSample& sample : record.samples) {
    const TetherCommand& c = sample.command;
    flown.is_finite &= std::isfinite(c.length_rate_m_s) && std::isfinite(c.elevation_rate_rad_s) &&
                       std::isfinite(c.azimuth_rate_rad_s) && std::isfinite(c.yaw_rate_rad_s);
    const double since_start_s = sample.t_s - kFaultStart_s;
    if (since_start_s >= kFaultDuration_s + 5) {
      flown.away_after_5_s_m =
          std::max(flown.away_after_5_s_m, sample.displacement_in_world_m.norm());
    }
    if (since_start_s < 0 || since_start_s > kFaultDuration_s) continue;
    const double way_m = (sample.drone_in_world_m - first->drone_in_world_m).norm();
    const double station_m = (sample.station_in_world_m - first->station_in_world_m).norm();
    flown.beyond_station_m = std::max(flown.beyond_station_m, way_m - station_m);
    flown.is_loss_told |=
        sample.verdict != Verdict::ok ||
        (sample.reason != HoldReason::none && sample.reason != HoldReason::within_dead_band);
  }
  int after = 0;
  for (const EstimateError& error : record.estimate_errors) {
    if (to_seconds(error.stamp) < kFaultStart_s) continue;
    flown.worst_place_m = std::max(flown.worst_place_m, error.position_error_m.value_or(HUGE_VAL));
    if (to_seconds(error.stamp) < kFaultStart_s + kFaultDuration_s) continue;
    if (!error.pose_nees) continue;
    flown.mean_nees_after += *error.pose_nees;
    ++after;
  }
  flown.mean_nees_after /= std::max(after, 1);
  return flown;
}

FaultyFlight fly_with(FaultKind kind) {
  return fly_with(faulty_flight(kind));
}

void expect_near_and_back(const FaultyFlight& flown) {
  EXPECT_TRUE(flown.is_finite);
  EXPECT_LT(flown.beyond_station_m, 0.3);
  EXPECT_LT(flown.away_after_5_s_m, 0.1);
}

std::string fault_name(const testing::TestParamInfo<FaultKind>& flight) {
  return std::string(name_of(flight.param));
}

// Along x, the way of these flights. Along y the reel at 0.3 m/s gains 0.1 m/s on a station that
// moves on: after 3 s of frozen video or slack tether it needs 5.7 s. And along y a cover does harm
// that stays: docs/reports/2026-11-22-faults.md.
class FaultThatIsTold : public testing::TestWithParam<FaultKind> {};

TEST_P(FaultThatIsTold, TheDroneStaysNearComesBackAndSaysSo) {
  const FaultyFlight flown = fly_with(GetParam());
  expect_near_and_back(flown);
  EXPECT_TRUE(flown.is_loss_told);
}

INSTANTIATE_TEST_SUITE_P(Each, FaultThatIsTold,
                         testing::Values(FaultKind::frozen_video, FaultKind::tether_slack),
                         fault_name);

// A moving cover is at times taken for the room, and what it leaves of the place depends on the
// last bit: below 0.10 m with one compiler's rounding, 0.12 m with another's.
TEST(Fault, BehindACoverTheDroneStaysNearAndSaysSo) {
  const FaultyFlight flown = fly_with(FaultKind::reference_blind);
  EXPECT_TRUE(flown.is_finite);
  // what it leaves may be enough: then nothing is lost
  EXPECT_TRUE(flown.is_loss_told || flown.worst_place_m < 0.05) << flown.worst_place_m;
  EXPECT_LT(flown.beyond_station_m, 0.3);
  EXPECT_LT(flown.away_after_5_s_m, 0.4);
}

// 3 s of inertia are as far off as they are said to be, and then the first image is found again.
// What its windows are off by hangs together: 12.6 is the 95 % quantile of one draw.
TEST(Fault, AfterTheDarkThePlaceIsAsUncertainAsTheEstimateSays) {
  const FaultyFlight flown = fly_with(FaultKind::picture_dark);
  expect_near_and_back(flown);
  EXPECT_TRUE(flown.is_loss_told);
  EXPECT_LT(flown.mean_nees_after, 12.6);
}

// These cost the estimate nothing that it would notice, or that it could: an image less is a
// longer interval, a steady offset of the stamps looks like none, the walls outvote the floor, and
// a bias is estimated. No verdict and no reason tells of them; the flight shows that they do act.
class FaultThatIsNotTold : public testing::TestWithParam<FaultKind> {};

TEST_P(FaultThatIsNotTold, TheDroneStaysNearAndComesBack) {
  expect_near_and_back(fly_with(GetParam()));
}

TEST_P(FaultThatIsNotTold, TheFlightIsAnotherOneFromItsStartOn) {
  HoverConfig config = faulty_flight(GetParam());
  config.plant.station.level_reach_m = 0.1;
  config.plant.fault->start_s = 1;
  const TrialRecord faulty = fly_trial(config, hover_world_of_faults(), {.seed = 3});
  config.plant.fault.reset();
  const TrialRecord sound = fly_trial(config, hover_world_of_faults(), {.seed = 3});
  ASSERT_EQ(faulty.samples.size(), sound.samples.size());
  double apart_m = 0;
  for (std::size_t i = 0; i < sound.samples.size(); ++i) {
    const Eigen::Vector3d difference_m =
        faulty.samples[i].drone_in_world_m - sound.samples[i].drone_in_world_m;
    if (sound.samples[i].t_s < 1) {
      EXPECT_EQ(difference_m.norm(), 0);
    }
    apart_m = std::max(apart_m, difference_m.norm());
  }
  EXPECT_GT(apart_m, 1e-5);
}

// A jump is none of what a data sheet says of the bias.
TEST(Fault, AGyroscopesBiasThatJumpsIsEstimatedHoweverWellItWasKnown) {
  HoverConfig config = faulty_flight(FaultKind::gyro_bias);
  config.navigator.fusion.gyro_bias_sigma_rad_s = 0.002;
  config.navigator.fusion.gyro_bias_walk = 2e-5;
  config.navigator.fusion.gyro_density = 1.7e-4;
  const FaultyFlight flown = fly_with(config);
  expect_near_and_back(flown);
  EXPECT_LT(flown.worst_place_m, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Each, FaultThatIsNotTold,
                         testing::Values(FaultKind::every_third_frame_lost, FaultKind::stamps_off,
                                         FaultKind::flow_blind, FaultKind::height_step,
                                         FaultKind::gyro_bias),
                         fault_name);

}  // namespace
}  // namespace stillkite
