#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "estimation/fusion/fusion_filter.hpp"
#include "tests/estimation/fusion/fusion_nees.hpp"
#include "tests/estimation/fusion/fusion_scene.hpp"

namespace stillkite {
namespace {

// 99 % band of the mean of 60 chi-square variables of 6 degrees of freedom
constexpr double kLow = 4.92;
constexpr double kHigh = 7.22;

int outside_the_band(const std::array<double, 10>& nees) {
  return static_cast<int>(
      std::count_if(nees.begin(), nees.end(), [](double x) { return x < kLow || x > kHigh; }));
}

// Too careful the filter may be at first: `depth_correlated_frames`.
void expect_not_too_sure(const std::array<double, 10>& nees) {
  EXPECT_LE(std::count_if(nees.begin(), nees.end(), [](double x) { return x > kHigh; }), 1);
  EXPECT_GT(*std::min_element(nees.begin() + 1, nees.end()), 0.6 * kLow);
}

// Seen for 3 s, left for 5 s of inertia alone, and found again: the place is known as before.
TEST(FusionFilter, ARestoredMapTellsThePlaceAndAnHonestCovariance) {
  constexpr int kSeeds = 60;
  double left_m = 0;
  double back_m = 0;
  double nees = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    FusionSimulation flight(FusionScene{}, few_landmarks(), static_cast<std::uint64_t>(seed) + 500);
    for (int i = 0; i < 90; ++i) flight.step();
    const FusionMap home = flight.filter().map();
    flight.filter().take_anchor();
    flight.cover(true);
    for (int i = 0; i < 150; ++i) flight.step();
    left_m += flight.pose_error().head<3>().norm() / kSeeds;
    flight.filter().restore(home);
    flight.cover(false);
    for (int i = 0; i < 30; ++i) flight.step();
    back_m += flight.pose_error().head<3>().norm() / kSeeds;
    nees += nees_of(flight) / kSeeds;
  }
  std::printf("off by %.3f m before, %.4f m after, NEES %.2f\n", left_m, back_m, nees);
  EXPECT_LT(back_m, 0.1 * left_m);
  // scale and vertical are the map's again, and may have been known better meanwhile
  EXPECT_GT(nees, 0.8 * kLow);
  EXPECT_LT(nees, kHigh);
}

// The map was left with a scale that was hardly known, and the IMU has told it since: the speed is
// known in metres, and is another one in the map's units.
TEST(FusionFilter, ARestoredMapOfAVagueScaleIsNoSurprise) {
  constexpr int kSeeds = 30;
  double nees = 0;
  FusionScene scene;
  scene.scale_error_log = 0.2;
  for (int seed = 0; seed < kSeeds; ++seed) {
    FusionSimulation flight(scene, few_landmarks(), static_cast<std::uint64_t>(seed) + 900);
    for (int i = 0; i < 45; ++i) flight.step();
    const FusionMap home = flight.filter().map();
    for (int i = 0; i < 250; ++i) flight.step();
    flight.filter().restore(home);
    for (int i = 0; i < 30; ++i) flight.step();
    nees += nees_of(flight) / kSeeds;
  }
  std::printf("NEES %.2f\n", nees);
  EXPECT_LT(nees, 10);
}

TEST(FusionFilter, CovarianceIsHonestWithAnImu) {
  expect_not_too_sure(nees_by_second(FusionScene{}, few_landmarks()));
}

// What windows are off by lasts as long as the camera stays: told of none the filter averages it
// away.
TEST(FusionFilter, CovarianceIsHonestWhereWindowErrorsLast) {
  FusionScene scene;
  scene.window_error_ratio = 1.5;
  FusionConfig config = few_landmarks();
  EXPECT_GT(most(nees_by_second(scene, config, 20)), 20) << "the case tells nothing";
  config.window_error_ratio = scene.window_error_ratio;
  config.window_error_way = scene.window_error_way;
  expect_not_too_sure(nees_by_second(scene, config));
}

// Where depths meet a window moves as no point does, by less than a view's noise at times: it must
// not turn the camera.
TEST(FusionFilter, CovarianceIsHonestAmongStrays) {
  FusionScene scene = hover_of_unknown_speed();
  scene.true_noise_ratio = 0.3;
  scene.strays = 6;
  scene.stray_px = 6;
  FusionConfig config = white_noise();
  config.stray_above_ratio = 1000;
  EXPECT_GT(most(nees_by_second(scene, config, 8)), 15) << "the case tells nothing";
  config.stray_above_ratio = FusionConfig{}.stray_above_ratio;
  EXPECT_LT(most(nees_by_second(scene, config, 8)), 9);
}

// Away from where it began, a reference a second: the lengths go from map to map.
TEST(FusionFilter, CovarianceIsHonestFromAnchorToAnchor) {
  FusionScene scene;
  scene.renew_every_s = 1;
  scene.drift_m_s2 = 0.05;
  expect_not_too_sure(nees_by_second(scene, few_landmarks()));
}

// Most of each new map is guessed, all too near by far: what lengths are is known from the old.
TEST(FusionFilter, GuessesOfALaterMapDoNotTellItsScale) {
  FusionScene scene;
  scene.renew_every_s = 1;
  scene.drift_m_s2 = 0.05;
  scene.renewed = 16;
  scene.renewed_error_log = 1.2;
  FusionConfig config = white_noise();
  config.landmarks = 24;
  EXPECT_LT(most(nees_by_second(scene, config, 20)), 8);
}

// The start leans by more than gravity leaves open: the upright pose heals, the other cannot.
TEST(FusionFilter, CovarianceOfTheUprightPoseIsHonestWhereTheStartLeans) {
  FusionScene scene;
  scene.sway_m = 1;
  scene.lean_sigma_rad = 0.05;
  double as_told = 0, upright = 0;
  constexpr int kSeeds = 60;
  for (int seed = 0; seed < kSeeds; ++seed) {
    FusionSimulation flight(scene, few_landmarks(), static_cast<std::uint64_t>(seed) + 100);
    while (flight.time_s() < 5) flight.step();
    const Vector6d error = flight.upright_pose_error();
    const Matrix6d P = flight.filter().upright_pose_covariance();
    EXPECT_LT(error.tail<3>().norm(), 0.03) << seed;
    upright += error.dot(P.ldlt().solve(error)) / kSeeds;
    as_told += nees_of(flight) / kSeeds;
  }
  std::printf("NEES %.2f, as told %.0f\n", upright, as_told);
  EXPECT_GT(as_told, 1000);
  EXPECT_GT(upright, 4.9);  // 99 % of means of 60 by six degrees of freedom
  EXPECT_LT(upright, 7.2);
}

TEST(FusionFilter, CovarianceIsHonestWithTheFlow) {
  FusionScene scene;
  scene.has_imu = false;
  scene.has_flow = true;
  // a depth known to 50 % is too vague to be linear (docs/fusion_honesty.md)
  scene.inverse_depth_spread = 0.2;
  FusionConfig config = few_landmarks();
  config.inverse_depth_sigma_ratio = scene.inverse_depth_spread;
  EXPECT_LE(outside_the_band(nees_by_second(scene, config)), 1);
}

// A speed of which nothing is known times depths that are guessed to 50 %: what no linear step
// knows of must not be believed, frame after frame. Too careful the filter may be.
TEST(FusionFilter, IsNotTooSureWhereTheSpeedAtTheStartIsNotKnown) {
  const FusionScene scene = hover_of_unknown_speed();
  FusionConfig config = white_noise();
  config.relinearize_start = false;
  config.depth_correlated_frames = 0;
  EXPECT_GT(most(nees_by_second(scene, config, 4)), 100) << "the case tells nothing";
  config.depth_correlated_frames = kCarefulFrames;
  EXPECT_LT(most(nees_by_second(scene, config, 8)), 12);
}

// Metres by inertia alone, of a start of no known height, guessed well or not.
TEST(FusionFilter, IsNotTooSureWhereNoHeightIsKnown) {
  FusionConfig config = white_noise();
  config.landmarks = 24;
  config.inverse_depth_sigma_ratio = 0.5;
  config.depth_correlated_frames = kCarefulFrames;
  config.relinearize_start = false;
  for (const double wrong_log : {-1.0, 0.0, 1.0}) {
    FusionScene scene;
    scene.turn_rad = 0.02;
    scene.velocity_sigma_m_s = 6;
    scene.log_unit_sigma = 1.5;
    scene.scale_error_log = wrong_log;
    EXPECT_LT(most(nees_by_second(scene, config, 10)), 12);
  }
}

}  // namespace
}  // namespace stillkite
