#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/hover/tethered_drone.hpp"

namespace stillkite {
namespace {

constexpr double kPlantStep_s = 0.005;

const StationState kRestingStation{.world_from_station = {.translation = {1, -2, 0.5}}};

TetheredDrone drone_over(const StationState& station, double yaw_rad = 0,
                         const TetheredDroneConfig& config = {}) {
  return {config, camera_raised_forward(75), station, yaw_rad};
}

// Hold paper, eq. (9)-(11).
Eigen::Vector3d on_tether(double length_m, double elevation_rad, double azimuth_rad) {
  return length_m * Eigen::Vector3d(std::cos(elevation_rad) * std::cos(azimuth_rad),
                                    std::cos(elevation_rad) * std::sin(azimuth_rad),
                                    std::sin(elevation_rad));
}

TEST(TetheredDrone, StaysAboveRestingStation) {
  TetheredDrone drone = drone_over(kRestingStation, 0.3);
  drone.step({}, {}, kRestingStation, 10);
  const DroneTruth& truth = drone.truth();
  EXPECT_LT((truth.world_from_body.translation - Eigen::Vector3d(1, -2, 2.5)).norm(), 1e-12);
  EXPECT_LT(truth.velocity_in_world_m_s.norm(), 1e-12);
  EXPECT_NEAR(to_euler(truth.world_from_body.rotation).yaw_rad, 0.3, 1e-12);
  EXPECT_EQ(truth.tether_status, TetherStatus::taut);
}

TEST(TetheredDrone, FollowsStationExactly) {
  for (const PaperAxis axis : {PaperAxis::x, PaperAxis::y, PaperAxis::z}) {
    const StationPath path({}, axis);
    TetheredDrone drone = drone_over(path.at(0));
    for (int k = 1; k * kPlantStep_s < path.duration_s(); ++k) {
      const StationState station = path.at(k * kPlantStep_s);
      drone.step({}, {}, station, kPlantStep_s);
      const Eigen::Vector3d above =
          drone.truth().world_from_body.translation - station.world_from_station.translation;
      ASSERT_LT((above - Eigen::Vector3d(0, 0, 2)).norm(), 1e-12);
      ASSERT_LT((drone.truth().velocity_in_world_m_s - station.velocity_in_world_m_s).norm(), 1e-3);
    }
  }
}

// A rate c behind a lag T: x = c (t - T (1 - exp(-t / T))).
TEST(TetheredDrone, FollowsCommandsWithFirstOrderLag) {
  const TetherCommand command{0.2, -0.15, 0.1, 0.3};
  TetheredDrone drone = drone_over(kRestingStation);
  const double t_s = 3.7;
  for (int k = 0; k < 37; ++k) drone.step(command, {}, kRestingStation, 0.1);
  const double run_s = t_s - 0.5 * (1 - std::exp(-t_s / 0.5));
  const Eigen::Vector3d expected =
      kRestingStation.world_from_station.translation +
      on_tether(2 + 0.2 * run_s, std::numbers::pi / 2 - 0.15 * run_s, 0.1 * run_s);
  EXPECT_LT((drone.truth().world_from_body.translation - expected).norm(), 1e-9);
  EXPECT_NEAR(to_euler(drone.truth().world_from_body.rotation).yaw_rad, 0.3 * run_s, 1e-9);
  EXPECT_NEAR(drone.truth().tether.length_m, 2 + 0.2 * run_s, 1e-9);
  EXPECT_NEAR(drone.truth().tether.elevation_rad, std::numbers::pi / 2 - 0.15 * run_s, 1e-9);
  EXPECT_NEAR(drone.truth().tether.azimuth_rad, 0.1 * run_s, 1e-9);
}

// Step size affects rounding only.
TEST(TetheredDrone, IsIndependentOfStepSize) {
  const TetherCommand command{0.2, -0.15, 0.1, 0.3};
  const Disturbance disturbance{.wind_in_world_m_s = {3, 1, 0}};
  TetheredDrone coarse = drone_over(kRestingStation);
  TetheredDrone fine = drone_over(kRestingStation);
  for (int k = 0; k < 10; ++k) coarse.step(command, disturbance, kRestingStation, 0.2);
  for (int k = 0; k < 400; ++k) fine.step(command, disturbance, kRestingStation, 0.005);
  EXPECT_LT((coarse.truth().world_from_body.translation - fine.truth().world_from_body.translation)
                .norm(),
            1e-12);
}

TEST(TetheredDrone, RespectsLimitsForAnyCommand) {
  TetheredDrone drone = drone_over(kRestingStation);
  constexpr double kHugeRate = 1e9;
  for (const double sign : {1.0, -1.0}) {
    DroneTruth last = drone.truth();
    for (int k = 0; k < 100 / kPlantStep_s; ++k) {
      drone.step({sign * kHugeRate, sign * kHugeRate, sign * kHugeRate, sign * kHugeRate}, {},
                 kRestingStation, kPlantStep_s);
      const TetherState& now = drone.truth().tether;
      ASSERT_LE(std::abs(now.length_m - last.tether.length_m), 0.3 * kPlantStep_s + 1e-12);
      ASSERT_LE(std::abs(now.elevation_rad - last.tether.elevation_rad),
                0.25 * kPlantStep_s + 1e-9);
      ASSERT_LE(std::abs(now.azimuth_rad - last.tether.azimuth_rad), 0.2 * kPlantStep_s + 1e-9);
      ASSERT_LE(std::abs(drone.truth().yaw_rate_rad_s), 0.4 + 1e-9);
      last = drone.truth();
    }
    EXPECT_EQ(last.tether.length_m, sign > 0 ? 20 : 0.3);
    EXPECT_NEAR(last.tether.elevation_rad, sign > 0 ? std::numbers::pi : 0, 1e-9);
  }
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  drone.step({kNan, kNan, kNan, kNan}, {}, kRestingStation, 10);
  EXPECT_TRUE(drone.truth().world_from_body.translation.allFinite());
}

// Displacement of 5 cm per m/s x (1 - exp(-t / 1 s)) across a tether of constant length.
TEST(TetheredDrone, WindDisplacementIsCompensatedByCommand) {
  TetheredDrone drone = drone_over(kRestingStation);
  const Disturbance wind{.wind_in_world_m_s = {4, 0, 0}};
  drone.step({}, wind, kRestingStation, 1);
  const Eigen::Vector3d start =
      kRestingStation.world_from_station.translation + Eigen::Vector3d(0, 0, 2);
  const double shift_m = 0.2 * (1 - std::exp(-1));
  EXPECT_NEAR((drone.truth().world_from_body.translation - start).x(),
              2 * std::sin(std::atan(shift_m / 2)), 1e-9);
  drone.step({}, wind, kRestingStation, 30);
  EXPECT_NEAR((drone.truth().world_from_body.translation - start).x(), 2 * std::sin(std::atan(0.1)),
              1e-9);
  EXPECT_NEAR(drone.truth().tether.elevation_rad, std::numbers::pi / 2 - std::atan(0.1), 1e-9);
  EXPECT_EQ(drone.truth().tether_status, TetherStatus::taut);
  // elevation change of atan(0.1) compensates the displacement
  drone.step({.elevation_rate_rad_s = std::atan(0.1)}, wind, kRestingStation, 1);
  drone.step({}, wind, kRestingStation, 30);
  EXPECT_NEAR((drone.truth().world_from_body.translation - start).x(), 0, 1e-3);
}

TEST(TetheredDrone, ReportsCauseOfSlackAndReducedDistance) {
  TetheredDrone drone = drone_over(kRestingStation);
  const auto distance_m = [&] {
    return (drone.truth().world_from_body.translation -
            kRestingStation.world_from_station.translation)
        .norm();
  };
  drone.step({}, {.wind_in_world_m_s = {0, 0, -5}}, kRestingStation, 30);
  EXPECT_EQ(drone.truth().tether_status, TetherStatus::taut);
  EXPECT_NEAR(distance_m(), 2, 1e-12);
  drone.step({}, {.wind_in_world_m_s = {0, 0, -10}}, kRestingStation, 30);
  EXPECT_EQ(drone.truth().tether_status, TetherStatus::slack_by_wind);
  EXPECT_NEAR(distance_m(), 2 - 0.05 * 4, 1e-9);
  EXPECT_EQ(drone.truth().tether.length_m, 2);
  drone.step({}, {.loose_tether_m = 0.4}, kRestingStation, 30);
  EXPECT_EQ(drone.truth().tether_status, TetherStatus::slack_by_fault);
  EXPECT_NEAR(distance_m(), 1.6, 1e-9);
  EXPECT_EQ(drone.truth().tether.length_m, 2);
}

TEST(TetheredDrone, YawKickKeepsCameraLevel) {
  TetheredDrone drone = drone_over(kRestingStation);
  drone.step({}, {.yaw_kick_rad = 20 * kDegree}, kRestingStation, 0.1);
  EXPECT_NEAR(to_euler(drone.truth().world_from_body.rotation).yaw_rad, 20 * kDegree, 1e-12);
  EXPECT_NEAR(drone.truth().yaw_rate_rad_s, 200 * kDegree, 1e-9);
  const Eigen::Quaterniond& R = drone.truth().world_from_camera.rotation;
  EXPECT_NEAR((R * Eigen::Vector3d::UnitX()).z(), 0, 1e-12);  // no roll
  const Eigen::Vector3d axis = R * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(axis.z(), -std::sin(15 * kDegree), 1e-12);
  EXPECT_NEAR(std::atan2(axis.y(), axis.x()), 20 * kDegree, 1e-12);
}

TEST(TetheredDrone, RejectsInitialLengthBeyondLimits) {
  EXPECT_THROW(drone_over(kRestingStation, 0, {.start_length_m = 21}), InputError);
}

}  // namespace
}  // namespace stillkite
