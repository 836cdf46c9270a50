#include "simulation/hover/sea_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/angle.hpp"
#include "simulation/hover/hover_plant.hpp"

namespace stillkite {
namespace {

constexpr SeaConfig kRoughSea{.significant_height_m = 0.8, .peak_period_s = 5, .towards_deg = 30};

WaterMotion water_at(const std::vector<RegularWave>& waves, double x_m, double y_m, double t_s) {
  return water_motion(waves, {}, {x_m, y_m}, Eigen::Vector2d::Zero(), t_s);
}

// Energy between adjacent waves: (H^2 / 16) / 60 = S x frequency spacing.
TEST(SeaMotion, WavesFollowSpectralDensity) {
  const std::vector<RegularWave> waves = make_waves(kRoughSea, 3);
  ASSERT_EQ(waves.size(), 60U);
  const double peak_rad_s = 2 * std::numbers::pi / 5;
  double narrowest_rad_s = 1;
  double at_narrowest_rad_s = 0;
  for (std::size_t i = 1; i < waves.size(); ++i) {
    const double w =
        0.5 * (waves[i].angular_frequency_rad_s + waves[i - 1].angular_frequency_rad_s);
    const double gap = waves[i].angular_frequency_rad_s - waves[i - 1].angular_frequency_rad_s;
    const double S = 5.0 / 16 * 0.8 * 0.8 * std::pow(peak_rad_s, 4) * std::pow(w, -5) *
                     std::exp(-1.25 * std::pow(peak_rad_s / w, 4));
    const bool is_narrow = i > 3 && i < 55;
    EXPECT_NEAR(S * gap * 60 * 16 / (0.8 * 0.8), 1, is_narrow ? 0.02 : 0.5) << i;
    if (gap >= narrowest_rad_s) continue;
    narrowest_rad_s = gap;
    at_narrowest_rad_s = w;
  }
  EXPECT_NEAR(at_narrowest_rad_s, peak_rad_s, 0.03 * peak_rad_s);
}

// Variance H^2 / 16; mean zero-upcrossing period 2 pi sqrt(m0 / m2) = T / (5 pi / 4)^(1/4).
TEST(SeaMotion, SurfaceHasVarianceAndMeanPeriodOfSpectrum) {
  const std::vector<RegularWave> waves = make_waves(kRoughSea, 4);
  constexpr double kDuration_s = 20000;
  constexpr double kStep_s = 0.1;
  double sum_of_squares = 0;
  int samples = 0, crossings = 0;
  double last_m = 0;
  for (double t_s = 0; t_s < kDuration_s; t_s += kStep_s, ++samples) {
    const double z_m = water_at(waves, 1, 2, t_s).displacement_in_world_m.z();
    sum_of_squares += z_m * z_m;
    if (last_m < 0 && z_m >= 0) ++crossings;
    last_m = z_m;
  }
  EXPECT_NEAR(sum_of_squares / samples, 0.8 * 0.8 / 16, 0.03 * 0.8 * 0.8 / 16);
  const double period_s = 5 / std::pow(1.25 * std::numbers::pi, 0.25);
  EXPECT_NEAR(kDuration_s / crossings, period_s, 0.04 * period_s);
}

// Density 2/pi cos^2: mean of the cosine 8 / (3 pi), of its square 3/4.
TEST(SeaMotion, DirectionsFollowCosineSquaredSpread) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0;
  constexpr int kSeas = 400;
  const Eigen::Vector2d along(std::cos(30 * kDegree), std::sin(30 * kDegree));
  for (int seed = 0; seed < kSeas; ++seed) {
    for (const RegularWave& wave : make_waves(kRoughSea, seed)) {
      const Eigen::Vector2d direction = wave.wave_vector_rad_m.normalized();
      sum += direction;
      squares += std::pow(direction.dot(along), 2);
      EXPECT_NEAR(wave.wave_vector_rad_m.norm() * 9.80665,
                  std::pow(wave.angular_frequency_rad_s, 2), 1e-9);
    }
  }
  EXPECT_LT((sum / (60 * kSeas) - 8 / (3 * std::numbers::pi) * along).norm(), 0.01);
  EXPECT_NEAR(squares / (60 * kSeas), 0.75, 0.01);
}

TEST(SeaMotion, SlopeIsSurfaceGradient) {
  const std::vector<RegularWave> waves = make_waves(kRoughSea, 5);
  const Waterplane boat{{0.6, 0.8}, 6, 2};
  const auto height_at = [&](double x_m, double y_m) {
    return water_motion(waves, boat, {x_m, y_m}, {0, 0}, 7).displacement_in_world_m.z();
  };
  const Eigen::Vector2d slope = water_motion(waves, boat, {3, -1}, {0, 0}, 7).slope;
  EXPECT_GT(slope.norm(), 1e-3);
  EXPECT_NEAR(slope.x(), (height_at(3 + 1e-4, -1) - height_at(3 - 1e-4, -1)) / 2e-4, 1e-7);
  EXPECT_NEAR(slope.y(), (height_at(3, -1 + 1e-4) - height_at(3, -1 - 1e-4)) / 2e-4, 1e-7);
}

// Wave of length 8 m and a boat of 8 m x 8/3 m. Factor 0 for a boat along the wave vector,
// sinc(pi / 3) across it. A point moves in a circle of radius a.
TEST(SeaMotion, BoatAveragesWavesOverWaterplane) {
  const double k = 2 * std::numbers::pi / 8;
  const RegularWave wave{0.2, std::sqrt(k * 9.80665), {k, 0}, 0};
  const auto crest_m = [&](const Eigen::Vector2d& ahead, double length_m) {
    return water_motion({wave}, {ahead, length_m, length_m / 3}, {0, 0}, {0, 0}, 0)
        .displacement_in_world_m.z();
  };
  EXPECT_NEAR(crest_m({1, 0}, 0), 0.2, 1e-12);
  EXPECT_NEAR(crest_m({1, 0}, 8), 0, 1e-12);
  EXPECT_NEAR(crest_m({0, 1}, 8), 0.2 * std::sin(std::numbers::pi / 3) / (std::numbers::pi / 3),
              1e-12);
  for (const double t_s : {0.0, 0.3, 1.1}) {
    const WaterMotion point = water_at({wave}, 0, 0, t_s);
    EXPECT_NEAR(point.displacement_in_world_m.norm(), 0.2, 1e-12);
    EXPECT_NEAR(point.velocity_in_world_m_s.dot(point.displacement_in_world_m), 0, 1e-12);
  }
  // on the crest the particle velocity points along the wave
  EXPECT_GT(water_at({wave}, 0, 0, 0).velocity_in_world_m_s.x(), 0);
}

TEST(SeaMotion, StationVelocityIsDerivativeOfPosition) {
  const StationPath path({.speed_m_s = 0.7}, PaperAxis::z);
  const std::vector<RegularWave> waves = make_waves(kRoughSea, 6);
  const auto at = [&](double t_s) { return station_on_boat(path.at(t_s), kRoughSea, waves, t_s); };
  for (const double t_s : {0.5, 2.0, 4.2, 6.0, 9.0, 20.0}) {
    const Eigen::Vector3d by_difference = (at(t_s + 1e-4).world_from_station.translation -
                                           at(t_s - 1e-4).world_from_station.translation) /
                                          2e-4;
    EXPECT_LT((at(t_s).velocity_in_world_m_s - by_difference).norm(), 1e-5) << t_s;
  }
}

TEST(SeaMotion, BoatStartsLevelAtRestKeepsHeadingAndDrifts) {
  const std::vector<RegularWave> waves = make_waves(kRoughSea, 7);
  const StationState on_land = StationPath({}, PaperAxis::z).at(0);
  const StationState start = station_on_boat(on_land, kRoughSea, waves, 0);
  EXPECT_EQ(start.world_from_station.translation, on_land.world_from_station.translation);
  EXPECT_LT(
      angle_between_rad(start.world_from_station.rotation, on_land.world_from_station.rotation),
      1e-12);
  EXPECT_EQ(start.velocity_in_world_m_s.norm(), 0);
  const StationState later = station_on_boat(on_land, kRoughSea, waves, 17);
  const Eigen::Vector3d up = later.world_from_station.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_LT(up.z(), 1 - 1e-5);
  const Eigen::Vector3d ahead = later.world_from_station.rotation * Eigen::Vector3d::UnitX();
  EXPECT_LT(std::abs(ahead.x()), 0.01);
  // without waves: drift for half of 5 s, then 95 s
  const StationState calm =
      station_on_boat(on_land, {.towards_deg = 90, .drift_m_s = 0.2}, make_waves({0}, 1), 100);
  EXPECT_LT((calm.world_from_station.translation - Eigen::Vector3d(0, 19.5, 1)).norm(), 1e-12);
}

// Without commands the tether is constant in the boat frame.
TEST(SeaMotion, TetheredDroneFollowsBoat) {
  HoverConfig config;
  config.plant.sea = kRoughSea;
  HoverPlant plant(config, {.stabilized = false, .seed = 5});
  HoverPlant again(config, {.stabilized = false, .seed = 5});
  HoverPlant other(config, {.stabilized = false, .seed = 6});
  for (int step = 0; step < 6000; ++step) {
    plant.step({});
    again.step({});
    other.step({});
  }
  const Eigen::Vector3d drone = plant.truth().world_from_body.translation;
  const Eigen::Vector3d above = plant.world_from_station() * Eigen::Vector3d(0, 0, 2);
  EXPECT_LT((drone - above).norm(), 1e-9);
  EXPECT_EQ(drone, again.truth().world_from_body.translation);
  EXPECT_GT((drone - other.truth().world_from_body.translation).norm(), 1e-3);
}

}  // namespace
}  // namespace stillkite
