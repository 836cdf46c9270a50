#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "estimation/fusion_filter.hpp"
#include "tests/estimation/fusion_scene.hpp"

namespace stillkite {
namespace {

// e^T P^-1 e of the pose: 6 when honest.
double nees_of(const FusionSimulation& flight) {
  const Vector6d error = flight.pose_error();
  return error.dot(flight.filter().pose_covariance().ldlt().solve(error));
}

// Averaged over seeds, second by second.
std::array<double, 10> nees_by_second(const FusionScene& scene, const FusionConfig& config,
                                      int seeds = 60) {
  std::array<double, 10> mean{};
  for (int seed = 0; seed < seeds; ++seed) {
    FusionSimulation flight(scene, config, static_cast<std::uint64_t>(seed) + 100);
    for (double& second : mean) {
      for (int i = 0; i < 30; ++i) flight.step();
      second += nees_of(flight) / seeds;
    }
  }
  std::printf("NEES, s 1 to 10:");
  for (const double second : mean) std::printf(" %.2f", second);
  std::printf("\n");
  return mean;
}

double nees_after_a_second(const FusionScene& scene, const FusionConfig& config, int seeds) {
  double mean = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    FusionSimulation flight(scene, config, static_cast<std::uint64_t>(seed) + 100);
    for (int i = 0; i < 30; ++i) flight.step();
    mean += nees_of(flight) / seeds;
  }
  std::printf("NEES after a second: %.2f\n", mean);
  return mean;
}

// 99 % band of the mean of 60 chi-square variables of 6 degrees of freedom
constexpr double kLow = 4.92;
constexpr double kHigh = 7.22;

double most(const std::array<double, 10>& nees) {
  return *std::max_element(nees.begin(), nees.end());
}

int outside_the_band(const std::array<double, 10>& nees) {
  return static_cast<int>(
      std::count_if(nees.begin(), nees.end(), [](double x) { return x < kLow || x > kHigh; }));
}

// Too careful the filter may be at first: `depth_correlated_frames`.
void expect_not_too_sure(const std::array<double, 10>& nees) {
  EXPECT_LE(std::count_if(nees.begin(), nees.end(), [](double x) { return x > kHigh; }), 1);
  EXPECT_GT(*std::min_element(nees.begin() + 1, nees.end()), 0.65 * kLow);
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

FusionScene hover_of_unknown_speed() {
  FusionScene scene;
  scene.sway_m = 0.1;
  scene.turn_rad = 0.01;
  scene.pixel_sigma_px = 0.2;
  scene.velocity_sigma_m_s = 6;
  return scene;
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

// What strays in the start is no landmark afterwards; what was offered takes its place.
TEST(FusionFilter, TakesOthersForLandmarksThatStray) {
  FusionScene scene = hover_of_unknown_speed();
  scene.true_noise_ratio = 0.3;
  scene.strays = 6;
  scene.stray_px = 6;
  scene.offered = 24;
  FusionConfig config = white_noise();
  config.landmarks = 24;
  FusionSimulation flight(scene, config, 1);
  while (flight.time_s() < 3) flight.step();
  int strays = 0;
  int others = 0;
  for (const Landmark& landmark : flight.filter().landmarks()) {
    if (landmark.feature < scene.strays) ++strays;
    if (landmark.feature >= config.landmarks) ++others;
  }
  EXPECT_LE(strays, 2);  // some stray as a depth would have it
  EXPECT_GE(others, 4);
  EXPECT_EQ(std::ssize(flight.filter().landmarks()), config.landmarks);
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

// The same where the start is gone through again: it need not be so careful then, and soon
// after a second knows its way as if it had known its speed.
TEST(FusionFilter, KnowsItsWayByThePicturesOfTheStartAsAWhole) {
  constexpr int kSeeds = 12;
  constexpr int kFrames = 36;
  const FusionScene scene = hover_of_unknown_speed();
  FusionConfig once = white_noise();
  once.relinearize_start = false;
  double once_m2 = 0;
  double again_m2 = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    FusionSimulation careful(scene, once, seed + 300);
    FusionSimulation flight(scene, white_noise(), seed + 300);
    for (int i = 0; i < kFrames; ++i) {
      careful.step();
      flight.step();
    }
    once_m2 += careful.pose_error().head<3>().squaredNorm() / kSeeds;
    again_m2 += flight.pose_error().head<3>().squaredNorm() / kSeeds;
  }
  std::printf("off by %.4f m, gone through once %.4f\n", std::sqrt(again_m2), std::sqrt(once_m2));
  EXPECT_LT(std::sqrt(again_m2), 0.4 * std::sqrt(once_m2));
  EXPECT_LT(most(nees_by_second(scene, white_noise(), kSeeds)), 10);
}

// Of pictures of things far and near, whose depths differ by more than the guesses are told to be
// off by, a turn and depths all alike explain nearly as much as the way: it must not be preferred.
TEST(FusionFilter, DoesNotTakeFarAndNearForAlike) {
  FusionScene scene;
  scene.sway_m = 0;
  scene.turn_rad = 0;
  scene.drift_m_s2 = 0.2;
  scene.inverse_depth_spread = 1;
  for (const double pixel_sigma_px : {0.2, 0.4}) {
    scene.pixel_sigma_px = pixel_sigma_px;
    FusionConfig config = white_noise();
    config.inverse_depth_sigma_ratio = 0.5;
    EXPECT_GT(nees_after_a_second(scene, config, 8), 30) << "the case tells nothing";
    config.inverse_depth_sigma_ratio = FusionConfig{}.inverse_depth_sigma_ratio;
    EXPECT_LT(nees_after_a_second(scene, config, 8), 9);
  }
}

// Pictures as noisy as haze's and a way of 1 cm: twenty of them settle at a turn instead, from all
// starts, and forty do not.
TEST(FusionFilter, LeavesAFalseStartOnceMorePicturesTell) {
  constexpr int kFrames = 90;
  FusionScene scene = hover_of_unknown_speed();
  scene.sway_m = 0.02;
  scene.turn_rad = 0.01;
  scene.drift_m_s2 = 0.05;
  scene.pixel_sigma_px = 1;
  const struct {
    double inverse_depth_spread = 0;
    std::uint64_t seed = 0;
  } flights[] = {{1.0, 313}, {1.8, 304}};
  for (const auto& [spread, seed] : flights) {
    scene.inverse_depth_spread = spread;
    FusionSimulation flight(scene, white_noise(), seed);
    for (int i = 0; i < kFrames; ++i) flight.step();
    EXPECT_LT(nees_of(flight), 50) << seed;
  }
}

// From rest, steadily faster to one side.
FusionScene slow_departure(double drift_m_s2) {
  FusionScene scene = hover_of_unknown_speed();
  scene.sway_m = 0;
  scene.turn_rad = 0;
  scene.drift_m_s2 = drift_m_s2;
  return scene;
}

// Twenty pictures of a slow way may as well show a turn: the likelier of both may be the false one.
TEST(FusionFilter, DoesNotBelieveAStartThatMayBeATurn) {
  constexpr int kSeeds = 4;
  constexpr int kFrames = 45;  // the one of 20 pictures is there, that of 40 is not
  FusionScene scene = slow_departure(0.05);
  scene.pixel_sigma_px = 0.7;
  double mean = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    FusionSimulation flight(scene, white_noise(), static_cast<std::uint64_t>(seed) + 100);
    for (int i = 0; i < kFrames; ++i) flight.step();
    mean += nees_of(flight) / kSeeds;
  }
  EXPECT_LT(mean, 8);
}

// Of a slower way forty may, and eighty tell: of eight seeds two that fail otherwise.
TEST(FusionFilter, WaitsForAStartThatCannotBeATurn) {
  constexpr int kFrames = 150;
  FusionScene scene = slow_departure(0.01);
  scene.inverse_depth_spread = 1;
  scene.pixel_sigma_px = 0.4;
  for (const std::uint64_t seed : {101, 103}) {
    FusionSimulation flight(scene, white_noise(), seed);
    for (int i = 0; i < kFrames; ++i) flight.step();
    EXPECT_LT(nees_of(flight), 20) << seed;
  }
}

// What way and depths are not known to is doubted as long as both are vague, not afterwards.
TEST(FusionFilter, DoubtsNoProductsOfDepthsThatTheStartHasTold) {
  const FusionScene scene = hover_of_unknown_speed();
  FusionConfig doubting = white_noise();
  doubting.depth_correlated_frames *= 100;
  FusionSimulation flight(scene, white_noise(), 302);
  FusionSimulation doubtful(scene, doubting, 302);
  const auto sigma_m = [](const FusionSimulation& f) {
    return std::sqrt(f.filter().pose_covariance().topLeftCorner<3, 3>().trace());
  };
  const auto fly = [&](int frames) {
    for (int i = 0; i < frames; ++i) {
      flight.step();
      doubtful.step();
    }
  };
  fly(25);
  EXPECT_GT(sigma_m(doubtful), 2 * sigma_m(flight)) << "the case tells nothing";
  fly(25);
  EXPECT_LT(sigma_m(doubtful), 1.02 * sigma_m(flight));
}

// Whatever the filter was told it is told again: where all is linear nothing changes.
TEST(FusionFilter, ForgetsNothingWhenItGoesThroughItsStartAgain) {
  constexpr double kHeight_sigma_m = 0.05;
  FusionScene scene;
  scene.has_flow = true;
  scene.sway_m = 0.1;
  scene.turn_rad = 0.005;
  scene.inverse_depth_spread = 0.02;
  FusionConfig config = few_landmarks();
  config.inverse_depth_sigma_ratio = scene.inverse_depth_spread;
  config.height_sigma_ratio = 0.05;
  config.scale_sigma_ratio = 0.05;
  FusionConfig plain = config;
  plain.relinearize_start = false;
  FusionSimulation again(scene, config, 1);
  FusionSimulation once(scene, plain, 1);
  const Eigen::Quaterniond start = once.truth().world_from_camera.rotation;
  for (int i = 0; i < 30; ++i) {
    for (FusionSimulation* flight : {&again, &once}) {
      const RigidTransform pose = flight->truth().world_from_camera;
      if (i == 10) flight->filter().doubt_height(0.05);
      flight->filter().update_up(pose.rotation.conjugate() * Eigen::Vector3d::UnitZ());
      flight->filter().update_height(pose.translation.z(), kHeight_sigma_m);
      flight->filter().update_turn(start.conjugate() * pose.rotation,
                                   1e-4 * Eigen::Matrix3d::Identity());
      flight->step();
    }
  }
  const auto expect_alike = [](const auto& a, const auto& b) {
    const Eigen::VectorXd ratio = a.diagonal().cwiseQuotient(b.diagonal());
    EXPECT_GT(ratio.minCoeff(), 0.95);
    EXPECT_LT(ratio.maxCoeff(), 1.05);
  };
  expect_alike(again.filter().pose_covariance(), once.filter().pose_covariance());
  expect_alike(again.filter().velocity_covariance(), once.filter().velocity_covariance());
  EXPECT_NEAR(again.filter().scale_sigma(), once.filter().scale_sigma(), 1e-3);
  EXPECT_LT((again.pose_error() - once.pose_error()).norm(), 1e-3);
  EXPECT_NE(again.pose_error(), once.pose_error()) << "it has not gone through anything again";
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
