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

TEST(Fault, IsActiveFromStartForDuration) {
  const FaultConfig fault{.kind = FaultKind::picture_dark, .start_s = 4, .duration_s = 2};
  EXPECT_EQ(effect_of(fault, 3.999).light_ratio, 1);
  EXPECT_EQ(effect_of(fault, 4).light_ratio, fault.light_ratio);
  EXPECT_EQ(effect_of(fault, 5.999).light_ratio, fault.light_ratio);
  EXPECT_EQ(effect_of(fault, 6).light_ratio, 1);
  EXPECT_EQ(effect_of(fault, 5).stamp_offset_s, 0);
}

TEST(Fault, TetherSlackHasConfiguredRate) {
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

TEST(Fault, GyroBiasIntegratesToPermanentHeadingError) {
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

TEST(Fault, OcclusionCoversUpperPartOnly) {
  const cv::Mat irradiance(40, 30, CV_32FC1, cv::Scalar(7));
  const cv::Mat image = occluded(irradiance, 0.75, 1.3);
  EXPECT_EQ(cv::countNonZero(image.rowRange(0, 30) == 7), 0);
  EXPECT_EQ(cv::countNonZero(image.rowRange(30, 40) != 7), 0);
}

TEST(Fault, DisplacesFloorOnly) {
  PatchScene scene;
  scene.patches.push_back({{1, 2, 0}, {3, 0, 0}, {0, -4, 0}, nullptr});
  scene.patches.push_back({{1, 2, 0}, {3, 0, 0}, {0, 0, -4}, nullptr});
  scene.patches.push_back({{1, 2, 4}, {3, 0, 0}, {0, 4, 0}, nullptr});
  const PatchScene moved = displace_floor(scene, {0.1, -0.2, 0.3});
  EXPECT_EQ(moved.patches[0].corner_in_world_m, Eigen::Vector3d(1.1, 1.8, 0.3));
  EXPECT_EQ(moved.patches[1].corner_in_world_m, scene.patches[1].corner_in_world_m);
  EXPECT_EQ(moved.patches[2].corner_in_world_m, scene.patches[2].corner_in_world_m);
}

constexpr double kFaultStart_s = 4;
constexpr double kFaultDuration_s = 3;

// Station path: amplitude 0.5 m, cruise speed 0.2 m/s.
HoverConfig faulty_config(FaultKind kind) {
  HoverConfig config;
  config.plant.camera = small_hover_camera(400, 20);
  config.plant.station.level_reach_m = 0.5;
  config.plant.fault =
      FaultConfig{.kind = kind, .start_s = kFaultStart_s, .duration_s = kFaultDuration_s};
  config.estimator = {.policy = Policy::fused, .mode = Mode::recommended};
  config.navigator.fusion.height_sigma_ratio = 0.02;
  return config;
}

const HoverWorld& fault_world() {
  static const HoverWorld made = make_hover_world(faulty_config(FaultKind::frozen_video));
  return made;
}

struct FaultyFlight {
  double excess_over_station_m = 0;     ///< max displacement since onset minus the station's
  double displacement_after_5_s_m = 0;  ///< maximum, from 5 s after the end of the fault
  double max_position_error_m = 0;      ///< of the estimate, from the onset
  double mean_nees_after = 0;           ///< of the pose, after the end of the fault
  bool is_loss_reported = false;        ///< by a verdict or reason during the fault
  bool is_finite = true;                ///< all commands
};

FaultyFlight fly_with(const HoverConfig& config) {
  const TrialRecord record = fly_trial(config, fault_world(), {.seed = 3});
  FaultyFlight flown;
  const auto first = std::find_if(record.samples.begin(), record.samples.end(),
                                  [](const TrialSample& s) { return s.t_s >= kFaultStart_s; });
  for (const TrialSample& sample : record.samples) {
    const TetherCommand& c = sample.command;
    flown.is_finite &= std::isfinite(c.length_rate_m_s) && std::isfinite(c.elevation_rate_rad_s) &&
                       std::isfinite(c.azimuth_rate_rad_s) && std::isfinite(c.yaw_rate_rad_s);
    const double since_start_s = sample.t_s - kFaultStart_s;
    if (since_start_s >= kFaultDuration_s + 5) {
      flown.displacement_after_5_s_m =
          std::max(flown.displacement_after_5_s_m, sample.displacement_in_world_m.norm());
    }
    if (since_start_s < 0 || since_start_s > kFaultDuration_s) continue;
    const double drone_displacement_m = (sample.drone_in_world_m - first->drone_in_world_m).norm();
    const double station_displacement_m =
        (sample.station_in_world_m - first->station_in_world_m).norm();
    flown.excess_over_station_m =
        std::max(flown.excess_over_station_m, drone_displacement_m - station_displacement_m);
    flown.is_loss_reported |=
        sample.verdict != Verdict::ok ||
        (sample.reason != HoldReason::none && sample.reason != HoldReason::within_dead_band);
  }
  int after = 0;
  for (const EstimateError& error : record.estimate_errors) {
    if (to_seconds(error.stamp) < kFaultStart_s) continue;
    flown.max_position_error_m =
        std::max(flown.max_position_error_m, error.position_error_m.value_or(HUGE_VAL));
    if (to_seconds(error.stamp) < kFaultStart_s + kFaultDuration_s) continue;
    if (!error.pose_nees) continue;
    flown.mean_nees_after += *error.pose_nees;
    ++after;
  }
  flown.mean_nees_after /= std::max(after, 1);
  return flown;
}

FaultyFlight fly_with(FaultKind kind) {
  return fly_with(faulty_config(kind));
}

void expect_near_and_returned(const FaultyFlight& flown) {
  EXPECT_TRUE(flown.is_finite);
  EXPECT_LT(flown.excess_over_station_m, 0.3);
  EXPECT_LT(flown.displacement_after_5_s_m, 0.1);
}

std::string fault_name(const testing::TestParamInfo<FaultKind>& info) {
  return std::string(name_of(info.param));
}

// Trials along x. Along y the reel at 0.3 m/s gains only 0.1 m/s on the moving station: recovery
// from 3 s of frozen video or slack tether takes 5.7 s, and the error from an occlusion is
// permanent (docs/benchmarks.md).
class DetectedFault : public testing::TestWithParam<FaultKind> {};

TEST_P(DetectedFault, DroneStaysNearReturnsAndReportsLoss) {
  const FaultyFlight flown = fly_with(GetParam());
  expect_near_and_returned(flown);
  EXPECT_TRUE(flown.is_loss_reported);
}

INSTANTIATE_TEST_SUITE_P(Each, DetectedFault,
                         testing::Values(FaultKind::frozen_video, FaultKind::tether_slack),
                         fault_name);

// The estimator sometimes tracks the moving occlusion: here 0.6 m of position error remain.
TEST(Fault, DroneStaysNearUnderOcclusionAndReportsLoss) {
  const FaultyFlight flown = fly_with(FaultKind::reference_blind);
  EXPECT_TRUE(flown.is_finite);
  // no loss if the visible part of the image suffices
  EXPECT_TRUE(flown.is_loss_reported || flown.max_position_error_m < 0.05)
      << flown.max_position_error_m;
  EXPECT_LT(flown.excess_over_station_m, 0.3);
  EXPECT_LT(flown.displacement_after_5_s_m, 0.7);
}

// Position errors after 3 s of inertial navigation, and after relocalization to the first image,
// are consistent. Patch errors are correlated over time: 12.6 is the 95 % quantile of a single
// sample.
TEST(Fault, CovarianceIsConsistentAfterDarkness) {
  const FaultyFlight flown = fly_with(FaultKind::picture_dark);
  expect_near_and_returned(flown);
  EXPECT_TRUE(flown.is_loss_reported);
  EXPECT_LT(flown.mean_nees_after, 12.6);
}

// Faults that the estimator tolerates or cannot observe: a lost frame is a longer interval, a
// constant stamp offset is unobservable, wall features outnumber floor features, and a gyroscope
// bias is estimated. No verdict or reason reports them.
class UndetectedFault : public testing::TestWithParam<FaultKind> {};

TEST_P(UndetectedFault, DroneStaysNearAndReturns) {
  expect_near_and_returned(fly_with(GetParam()));
}

TEST_P(UndetectedFault, ChangesFlightFromOnset) {
  HoverConfig config = faulty_config(GetParam());
  config.plant.station.level_reach_m = 0.1;
  config.plant.fault->start_s = 1;
  const TrialRecord faulty = fly_trial(config, fault_world(), {.seed = 3});
  config.plant.fault.reset();
  const TrialRecord undisturbed = fly_trial(config, fault_world(), {.seed = 3});
  ASSERT_EQ(faulty.samples.size(), undisturbed.samples.size());
  double max_difference_m = 0;
  for (std::size_t i = 0; i < undisturbed.samples.size(); ++i) {
    const Eigen::Vector3d difference_m =
        faulty.samples[i].drone_in_world_m - undisturbed.samples[i].drone_in_world_m;
    if (undisturbed.samples[i].t_s < 1) {
      EXPECT_EQ(difference_m.norm(), 0);
    }
    max_difference_m = std::max(max_difference_m, difference_m.norm());
  }
  EXPECT_GT(max_difference_m, 1e-5);
}

// A bias step exceeds the configured bias prior and random walk.
TEST(Fault, EstimatesGyroBiasStepDespiteTightPrior) {
  HoverConfig config = faulty_config(FaultKind::gyro_bias);
  config.navigator.fusion.gyro_bias_sigma_rad_s = 0.002;
  config.navigator.fusion.gyro_bias_walk = 2e-5;
  config.navigator.fusion.gyro_density = 1.7e-4;
  const FaultyFlight flown = fly_with(config);
  expect_near_and_returned(flown);
  EXPECT_LT(flown.max_position_error_m, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Each, UndetectedFault,
                         testing::Values(FaultKind::every_third_frame_lost, FaultKind::stamps_off,
                                         FaultKind::flow_blind, FaultKind::height_step,
                                         FaultKind::gyro_bias),
                         fault_name);

}  // namespace
}  // namespace stillkite
