#include "estimation/fusion/fusion_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

#include "tests/estimation/fusion/fusion_scene.hpp"

namespace stillkite {
namespace {

TEST(FusionFilter, FindsTheScaleByItsInertia) {
  FusionScene scene;
  scene.scale_error_log = 0.4;
  FusionSimulation flight(scene, FusionConfig{}, 3);
  const double before = flight.filter().scale_sigma();
  for (int i = 0; i < 300; ++i) flight.step();
  EXPECT_LT(flight.filter().scale_sigma(), 0.1 * before);
  EXPECT_LT(flight.pose_error().head<3>().norm(), 0.02);
}

// Its noise is no acceleration: taken for one that good images do not show, it tells of longer
// metres, by 16 % in the mean of these flights.
TEST(FusionFilter, ANoisyAccelerometerTellsNoLongerMetres) {
  constexpr int kSeeds = 40;
  FusionScene scene = hover_of_unknown_speed();
  scene.pixel_sigma_px = 0.05;
  double mean_log = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    FusionSimulation flight(scene, white_noise(), seed);
    const Eigen::Vector3d start_m = flight.truth().world_from_camera.translation;
    double found = 0, truth = 0;  // of the ways, as far as they are alike
    while (flight.time_s() < 5) {
      flight.step();
      const Eigen::Vector3d way_m = flight.truth().world_from_camera.translation - start_m;
      if (flight.time_s() < 4) continue;
      found += way_m.dot(flight.filter().world_from_camera_m().translation - start_m);
      truth += way_m.squaredNorm();
    }
    mean_log += std::log(found / truth) / kSeeds;
  }
  std::printf("metres too long by %.3f\n", mean_log);
  EXPECT_LT(std::abs(mean_log), 0.1);
}

// A mean force is that of half way: taken for that of the step's beginning it would be a speed.
TEST(FusionFilter, KeepsItsPlaceInATurnOnTheSpot) {
  constexpr double kStep_s = 1.0 / 100;
  const Eigen::Vector3d rate_rad_s(2, 0, 0);
  FusionFilter filter({}, {.world_from_camera = {Eigen::Quaterniond::Identity(), {0, 0, 1}}});
  for (int i = 0; i < 100; ++i) {
    const Eigen::Quaterniond half_way = so3_exp((i + 0.5) * kStep_s * rate_rad_s);
    filter.predict({.dt_s = kStep_s,
                    .angular_rate_rad_s = rate_rad_s,
                    .is_gyro = true,
                    .specific_force_m_s2 = half_way.conjugate() * Eigen::Vector3d(0, 0, 9.80665)});
  }
  EXPECT_LT(filter.velocity_in_world_m_s().norm(), 1e-3);
}

// Without any metric sensor the way home is known as a direction, the scale as at the start.
TEST(FusionFilter, LearnsNoScaleFromImagesAlone) {
  FusionScene scene;
  scene.has_imu = false;
  FusionSimulation flight(scene, FusionConfig{}, 4);
  const double before = flight.filter().scale_sigma();
  for (int i = 0; i < 300; ++i) flight.step();
  EXPECT_NEAR(flight.filter().scale_sigma(), before, 0.04 * before);
  EXPECT_GE(flight.filter().scale_sigma(), before);
}

// A start of unknown height is one map unit up, whatever that is.
TEST(FusionFilter, TheFirstHeightIsTheUnit) {
  FusionFilter filter({}, {.world_from_camera = {{}, {0, 0, 1}}, .log_unit_sigma = 1.5});
  EXPECT_TRUE(filter.update_height(20, 0.2));
  EXPECT_NEAR(filter.world_from_camera_m().translation.z(), 20, 0.1);
  EXPECT_NEAR(filter.state().log_scale, std::log(20), 0.01);
}

TEST(FusionFilter, RefusesAHeightThatCannotBe) {
  FusionFilter filter({}, {.world_from_camera = {{}, {0, 0, 3}}});
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const double height_m : {4.0, 0.0, -3.0, kNaN, HUGE_VAL}) {
    EXPECT_FALSE(filter.update_height(height_m, 0.02)) << height_m;
  }
  filter.doubt_height(0.3);
  EXPECT_TRUE(filter.update_height(4, 0.02));
}

// What a barometer says of a climb is metres, where landmarks know the way but for its unit.
TEST(FusionFilter, HeightsTellMetresWithoutInertia) {
  double nees = 0;
  constexpr int kSeeds = 10;
  FusionConfig config;
  config.landmarks = 16;
  for (int seed = 0; seed < kSeeds; ++seed) {
    FusionScene scene;
    scene.has_imu = false;
    scene.sway_m = 1;
    scene.scale_error_log = 0.2;
    FusionSimulation flight(scene, config, 60 + seed);
    const double before = flight.filter().scale_sigma();
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> error_m(0, 0.02);
    for (int i = 0; i < 300; ++i) {
      flight.step();
      flight.filter().update_height(
          flight.truth().world_from_camera.translation.z() + error_m(engine), 0.02);
    }
    EXPECT_LT(flight.filter().scale_sigma(), 0.5 * before) << seed;
    const Vector6d error = flight.pose_error();
    nees += error.dot(flight.filter().pose_covariance().ldlt().solve(error)) / kSeeds;
  }
  std::printf("NEES %.2f\n", nees);
  EXPECT_LT(nees, 10);
}

// A turn that is unknown to 0.5 rad/s/sqrt(Hz) and one that is measured: weighted by both.
TEST(FusionFilter, WeighsATurnThatIsMeasured) {
  const Eigen::Quaterniond start = so3_exp(Eigen::Vector3d(0.3, -0.5, 1.1));
  FusionFilter filter({}, {.world_from_camera = {start, {0, 0, 3}}});
  filter.predict({.dt_s = 0.04, .angular_rate_rad_s = {}, .is_gyro = false});
  const Eigen::Matrix3d before = 0.01 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d noise = Eigen::Vector3d(4e-2, 1e-2, 1e-4).asDiagonal();
  const Eigen::Vector3d seen(3e-3, -2e-3, 1e-3);
  EXPECT_FALSE(filter.update_turn(so3_exp(Eigen::Vector3d(0, 0, 1)), noise));
  ASSERT_TRUE(filter.update_turn(so3_exp(seen), noise));
  const Eigen::Matrix3d after = (before.inverse() + noise.inverse()).inverse();
  EXPECT_LT((filter.anchored_covariance().bottomRightCorner<3, 3>() - after).norm(), 1e-9);
  const Eigen::Vector3d turn = so3_log(filter.anchor_from_camera_m().rotation);
  EXPECT_LT((turn - after * noise.inverse() * seen).norm(), 1e-5);
}

// Views that are all off alike do not contradict each other.
TEST(FusionFilter, FollowsAGyroscopesBiasThatJumps) {
  FusionScene scene;
  scene.pixel_sigma_px = 0.05;
  FusionSimulation flight(scene, white_noise(), 5);
  while (flight.time_s() < 4) flight.step();
  flight.shift_gyro_bias(1 * kDegree);
  double most_m = 0;
  while (flight.time_s() < 6) {
    flight.step();
    most_m = std::max(most_m, flight.pose_error().head<3>().norm());
  }
  const Vector6d error = flight.pose_error();
  EXPECT_LT(most_m, 0.01);
  EXPECT_LT(error.dot(flight.filter().pose_covariance().ldlt().solve(error)), 20);
}

TEST(FusionFilter, DoubtsNoGyroscopeWhereNothingIsSeen) {
  FusionSimulation flight(FusionScene{}, white_noise(), 5);
  while (flight.time_s() < 2) flight.step();
  const double known = flight.filter().gyro_bias_covariance().trace();
  flight.cover(true);
  while (flight.time_s() < 3) {
    flight.step();
    flight.filter().update_landmarks({});
  }
  EXPECT_LT(flight.filter().gyro_bias_covariance().trace(), 2 * known);
}

TEST(FusionFilter, RefusesALandmarkThatJumps) {
  FusionSimulation flight(FusionScene{}, FusionConfig{}, 5);
  for (int i = 0; i < 30; ++i) flight.step();
  const RigidTransform before = flight.filter().world_from_camera_m();
  const FeatureView far_off{0, {0.9, 0.9}, 1e-6 * Eigen::Matrix2d::Identity()};
  EXPECT_EQ(flight.filter().update_landmarks({&far_off, 1}), 0);
  EXPECT_EQ(flight.filter().world_from_camera_m().translation, before.translation);
}

// Where edges of things at different depths cross, what is seen moves as no point does. It stays
// within what a view is said to be off by, and would turn the camera.
TEST(FusionFilter, DropsALandmarkThatMovesAsNoPointDoes) {
  FusionScene scene;
  scene.turn_rad = 0;
  scene.true_noise_ratio = 0.2;
  scene.first_moves_backwards = true;
  FusionSimulation flight(scene, white_noise(), 8);
  for (int i = 0; i < 90; ++i) flight.step();
  EXPECT_EQ(flight.filter().dropped(), std::vector<int>{0});
  EXPECT_LT(flight.pose_error().tail<3>().norm(), 2e-4);
  // as long as its reference lasts, and again when that is found again
  const FusionMap home = flight.filter().map();
  flight.filter().take_anchor();
  EXPECT_TRUE(flight.filter().dropped().empty());
  flight.filter().restore(home);
  EXPECT_EQ(flight.filter().dropped(), std::vector<int>{0});
}

// After 3 s without a view every one of them is near enough to a prediction so vague; but only one
// is where the others cannot have it.
TEST(FusionFilter, RefusesWhatContradictsTheOthers) {
  FusionSimulation flight(FusionScene{}, few_landmarks(), 7);
  for (int i = 0; i < 90; ++i) flight.step();
  flight.cover(true);
  for (int i = 0; i < 90; ++i) flight.step();
  const double unseen_m = flight.pose_error().head<3>().norm();
  flight.cover(false);
  flight.shift_first(20);
  flight.step();
  int refused = 0;
  for (const Landmark& landmark : flight.filter().landmarks()) {
    refused += landmark.refused;
    EXPECT_EQ(landmark.refused > 0, landmark.feature == 0) << landmark.feature;
  }
  EXPECT_EQ(refused, 1);
  EXPECT_LT(flight.pose_error().head<3>().norm(), 0.2 * unseen_m);
}

// Also where so many are off that the gyroscope and the place are doubted first.
TEST(FusionFilter, CountsARefusalOnceAFrame) {
  FusionConfig config = white_noise();
  config.landmarks = 24;
  FusionSimulation flight(FusionScene{}, config, 7);
  for (int i = 0; i < 90; ++i) flight.step();
  flight.shift_first(20, 10);
  for (int frames = 1; frames <= 2; ++frames) {
    flight.step();
    for (const Landmark& landmark : flight.filter().landmarks()) {
      EXPECT_LE(landmark.refused, frames) << landmark.feature;
      EXPECT_TRUE(landmark.feature >= 10 || landmark.refused == frames) << landmark.feature;
    }
  }
}

// Once they are chosen, nothing is dropped for its noise.
TEST(FusionFilter, KeepsLandmarksThatAreMerelyNoisy) {
  FusionSimulation flight(FusionScene{}, FusionConfig{}, 9);
  while (flight.time_s() < 3) flight.step();
  const std::vector<int> dropped_by_the_start = flight.filter().dropped();
  while (flight.time_s() < 10) flight.step();
  EXPECT_EQ(flight.filter().dropped(), dropped_by_the_start);
}

// What is seen of a floor whose height is known tells the scale.
TEST(FusionFilter, FindsTheScaleByTheGround) {
  FusionScene scene;
  scene.has_imu = false;
  scene.inverse_depth_spread = 0.01;  // nearly all of them on the ground as it is guessed
  FusionConfig config;
  config.inverse_depth_sigma_ratio = scene.inverse_depth_spread;
  FusionSimulation flight(scene, config, 7);
  for (int i = 0; i < 90; ++i) {
    flight.step();
    flight.filter().update_ground(false);
  }
  EXPECT_NEAR(flight.filter().state().log_scale, 0.0, 0.06);
  EXPECT_LT(flight.filter().scale_sigma(), 0.05);
}

// Landmarks half as far down as ahead, so far below a camera 3 m up, and known to that share, each
// and all alike.
struct LowPoint {
  double below_m = 0;
  double sigma_ratio = 0;
};

FusionFilter filter_with(const std::vector<LowPoint>& points, double common_ratio = 0) {
  const Eigen::Matrix3d ahead = (Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished();
  FusionFilter filter({}, {.world_from_camera = {Eigen::Quaterniond(ahead), {0, 0, 3}}});
  filter.take_anchor();
  FusionMap map = filter.map();
  const Eigen::MatrixXd known = map.covariance;
  const Eigen::Index before = known.rows();
  Eigen::VectorXd variance =
      Eigen::VectorXd::Zero(before + 3 * static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double inverse_depth = 0.5 / points[i].below_m;
    map.landmarks.push_back({.feature = static_cast<int>(i),
                             .bearing = {0.01 * static_cast<double>(i), 0.5},
                             .inverse_depth = inverse_depth});
    variance.segment<3>(before + 3 * static_cast<Eigen::Index>(i)) << 1e-8, 1e-8,
        square(points[i].sigma_ratio * inverse_depth);
  }
  Eigen::VectorXd common = Eigen::VectorXd::Zero(variance.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    common[before + 3 * static_cast<Eigen::Index>(i) + 2] =
        common_ratio * map.landmarks[i].inverse_depth;
  }
  map.covariance = common * common.transpose();
  map.covariance.topLeftCorner(before, before) += known;
  map.covariance.diagonal() += variance;
  filter.restore(map);
  return filter;
}

// A table is known first, for it is nearer: as long as others are known to lie below it, it is not
// taken for the ground, even if their own level is not known well enough. One alone may be wrong.
TEST(FusionFilter, TakesNoTableForTheGround) {
  const std::vector<LowPoint> table(5, {.below_m = 2.2, .sigma_ratio = 0.01});
  const auto with = [&](std::size_t count, double below_m, double sigma_ratio) {
    std::vector<LowPoint> points = table;
    points.insert(points.end(), count, {.below_m = below_m, .sigma_ratio = sigma_ratio});
    return points;
  };
  EXPECT_EQ(filter_with(with(5, 3, 0.05)).update_ground(false), 0);
  EXPECT_EQ(filter_with(with(5, 3, 0.3)).update_ground(false), 5);  // they may be anywhere
  EXPECT_EQ(filter_with(with(1, 3, 0.05)).update_ground(false), 5);
  FusionFilter knows_floor = filter_with(with(5, 3, 0.01));
  EXPECT_EQ(knows_floor.update_ground(false), 5);
  for (const Landmark& landmark : knows_floor.landmarks()) {
    EXPECT_EQ(landmark.is_on_ground, landmark.feature >= 5);
  }
}

// Five lie on the ground and ten 9 cm over it, which is no matter where heights are known to 2 %.
// Known to 0.2 % these are other things, and told as ground they would make metres too long.
TEST(FusionFilter, TakesNothingForTheGroundThatIsKnownToLieOverIt) {
  const auto with = [](double sigma_ratio) {
    std::vector<LowPoint> points(5, {.below_m = 3, .sigma_ratio = sigma_ratio});
    points.insert(points.end(), 10, {.below_m = 2.91, .sigma_ratio = sigma_ratio});
    return filter_with(points);
  };
  EXPECT_EQ(with(0.02).update_ground(false), 15);
  FusionFilter knows_heights = with(0.002);
  EXPECT_EQ(knows_heights.update_ground(false), 5);
  EXPECT_NEAR(knows_heights.state().log_scale, 0, 0.002);
}

// None of five lies on a level with the others as well as heights are known: the middle ones tell.
TEST(FusionFilter, FindsTheGroundWhereItIsRough) {
  FusionFilter filter =
      filter_with({{3, 0.001}, {2.975, 0.001}, {2.95, 0.001}, {2.925, 0.001}, {2.9, 0.001}});
  EXPECT_EQ(filter.update_ground(false), 3);
  EXPECT_NEAR(filter.state().log_scale, std::log(3 / 2.95), 0.005);
}

// In a unit that is wrong by two thirds nine heights that are alike are one and the same scale: the
// first of them must not settle it where the others are not. That a unit was wrong says nothing of
// the metres that were given.
TEST(FusionFilter, TellsAScaleThatIsWrongByFarAtOnce) {
  for (const double below : {1.5, 3.0, 5.0}) {
    FusionFilter filter = filter_with(std::vector<LowPoint>(9, {below, 0.001}));
    EXPECT_EQ(filter.update_ground(false), 9) << below;
    EXPECT_NEAR(filter.state().log_scale, std::log(3 / below), 0.005) << below;
    EXPECT_NEAR(filter.state().log_height, 0, 1e-4) << below;
  }
}

// Of fourteen heights four on another level are relief, three are none; nor is what may be noise,
// or too few of known height.
TEST(FusionFilter, SeesReliefWhereHeightsDiffer) {
  const auto shows_relief = [](int low, int high, double high_m, double sigma_ratio) {
    std::vector<LowPoint> points(static_cast<std::size_t>(low), {3, sigma_ratio});
    points.insert(points.end(), static_cast<std::size_t>(high), {high_m, sigma_ratio});
    return filter_with(points).shows_relief();
  };
  EXPECT_TRUE(shows_relief(10, 4, 2, 0.01));
  EXPECT_FALSE(shows_relief(11, 3, 2, 0.01));
  EXPECT_FALSE(shows_relief(10, 4, 2.8, 0.01));
  EXPECT_FALSE(shows_relief(10, 4, 2.4, 0.05));
  EXPECT_FALSE(shows_relief(10, 4, 2, 0.2));
  EXPECT_FALSE(shows_relief(5, 4, 2, 0.01));
}

// Depths that were all off by 10 % when they told the scale, and are known since: they tell it
// again.
TEST(FusionFilter, TellsTheScaleAgainOnceDepthsAreKnownMuchBetter) {
  FusionFilter filter = filter_with(std::vector<LowPoint>(9, {3, 0.001}), 0.1);
  EXPECT_EQ(filter.update_ground(false), 9);
  EXPECT_GT(filter.scale_sigma(), 0.08);
  FusionMap map = filter.map();
  constexpr Eigen::Index kScale = FusionIndex::kScale - FusionIndex::kTilt;
  map.covariance.setZero();
  map.covariance.diagonal().setConstant(1e-10);
  map.covariance(kScale, kScale) = square(0.03);
  for (Landmark& landmark : map.landmarks) landmark.inverse_depth /= 1.1;
  filter.restore(map);
  EXPECT_EQ(filter.update_ground(false), 9);
  EXPECT_NEAR(filter.state().log_scale, std::log(1 / 1.1), 0.005);
  EXPECT_EQ(filter.update_ground(false), 0);
}

// The lowest of nine that are off by 3 % each look lower than the ground is: they do not tell the
// scale to 1 %, as nine independent ones would.
TEST(FusionFilter, CountsThatTheLowestWereChosen) {
  const auto scale_variance = [](double sigma_ratio) {
    FusionFilter filter = filter_with(std::vector<LowPoint>(9, {3, sigma_ratio}));
    EXPECT_EQ(filter.update_ground(false), 9);
    return square(filter.scale_sigma());
  };
  EXPECT_GT(std::sqrt(scale_variance(0.03) - scale_variance(0.001)), 0.03);
}

}  // namespace
}  // namespace stillkite
