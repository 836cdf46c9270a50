#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "simulation/flight/flight.hpp"

namespace stillkite {
namespace {

struct DerivativeTolerances {
  double velocity_m_s, acceleration_m_s2, rate_rad_s;
};

// Reference: central differences of pose and velocity.
void expect_derivatives(const Trajectory& trajectory, double t_s, double step_s,
                        const DerivativeTolerances& max) {
  const MotionState before = trajectory.at(t_s - step_s);
  const MotionState here = trajectory.at(t_s);
  const MotionState after = trajectory.at(t_s + step_s);
  const Eigen::Vector3d velocity =
      (after.world_from_body.translation - before.world_from_body.translation) / (2 * step_s);
  const Eigen::Vector3d acceleration =
      (after.velocity_in_world_m_s - before.velocity_in_world_m_s) / (2 * step_s);
  const Eigen::Vector3d rate =
      so3_log(before.world_from_body.rotation.conjugate() * after.world_from_body.rotation) /
      (2 * step_s);
  EXPECT_LT((velocity - here.velocity_in_world_m_s).norm(), max.velocity_m_s) << t_s;
  EXPECT_LT((acceleration - here.acceleration_in_world_m_s2).norm(), max.acceleration_m_s2) << t_s;
  EXPECT_LT((rate - here.angular_rate_in_body_rad_s).norm(), max.rate_rad_s) << t_s;
}

class Derivatives : public testing::TestWithParam<FlightShape> {};

TEST_P(Derivatives, MatchFiniteDifferences) {
  FlightConfig config{.shape = GetParam(), .heading_deg = 40, .pitch_deg = 12, .roll_deg = -25};
  config.tilt_sway_deg = 8;
  config.yaw_sway_deg = 20;
  const Trajectory trajectory = make_trajectory(config, 17);
  for (double t_s = 0.5; t_s < 150; t_s += 7.3) {
    expect_derivatives(trajectory, t_s, 3e-5, {1e-6, 1e-6, 1e-7});
  }
}

INSTANTIATE_TEST_SUITE_P(Trajectory, Derivatives,
                         testing::Values(FlightShape::line, FlightShape::turn,
                                         FlightShape::out_and_back, FlightShape::hand),
                         [](const auto& shape) { return std::string(name_of(shape.param)); });

TEST(Trajectory, RestsAndThenStartsSmoothly) {
  FlightConfig config{.duration_s = 20, .height_m = 100, .rest_s = 3};
  config.tilt_sway_deg = 8;
  const Trajectory trajectory = make_trajectory(config, 17);
  const MotionState start = trajectory.at(0);
  const MotionState last = trajectory.at(3);
  EXPECT_EQ(start.world_from_body.translation, last.world_from_body.translation);
  EXPECT_LT((start.world_from_body.translation - Eigen::Vector3d(0, 0, 100)).norm(), 1e-9);
  EXPECT_EQ(last.velocity_in_world_m_s.norm(), 0);
  EXPECT_EQ(last.acceleration_in_world_m_s2.norm(), 0);
  EXPECT_EQ(last.angular_rate_in_body_rad_s.norm(), 0);
  EXPECT_LT((trajectory.at(20).world_from_body.translation - Eigen::Vector3d(1000, 100, 50)).norm(),
            1e-9);
  for (double t_s = 2.95; t_s < 4.3; t_s += 0.0917) {
    expect_derivatives(trajectory, t_s, 1e-5, {1e-5, 1e-4, 1e-6});
  }
}

TEST(Trajectory, HandMotionHasConfiguredRmsAndBand) {
  FlightConfig config{
      .shape = FlightShape::hand, .duration_s = 150, .height_m = 1.5, .sway_m = 0, .hand_m = 0.04};
  config.tilt_sway_deg = config.yaw_sway_deg = 0;
  const Trajectory trajectory = make_trajectory(config, 5);
  EXPECT_LT((trajectory.at(0).world_from_body.translation - Eigen::Vector3d(0, 0, 1.5)).norm(),
            1e-9);
  for (const Signal* signal : {&trajectory.x_m, &trajectory.z_m, &trajectory.roll_rad}) {
    double power = 0;
    for (const Signal::Sine& sine : signal->sines) {
      if (sine.amplitude == 0) continue;
      power += 0.5 * sine.amplitude * sine.amplitude;
      EXPECT_GE(sine.frequency_rad_s, 2 * std::numbers::pi * 0.3);
      EXPECT_LE(sine.frequency_rad_s, 2 * std::numbers::pi * 3 * (1 + 1e-9));
    }
    EXPECT_NEAR(std::sqrt(power), signal == &trajectory.roll_rad ? 2 * kDegree : 0.04, 1e-9);
  }
}

TEST(Trajectory, DefaultsToFlowPaperFlight) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Trajectory trajectory = make_trajectory({}, seed);
    EXPECT_LT((trajectory.at(0).world_from_body.translation - Eigen::Vector3d(0, 0, 400)).norm(),
              1e-9);
    EXPECT_LT(
        (trajectory.at(150).world_from_body.translation - Eigen::Vector3d(1000, 100, 350)).norm(),
        1e-9);
    double square = 0;
    double largest = 0;
    for (int t_s = 0; t_s <= 150; ++t_s) {
      const double tilt = tilt_rad(trajectory.at(t_s).world_from_body.rotation);
      square += tilt * tilt / 151;
      largest = std::max(largest, tilt);
    }
    // roll and pitch: 1.2 deg RMS each
    EXPECT_NEAR(std::sqrt(square) / kDegree, 1.2 * std::numbers::sqrt2, 0.6);
    EXPECT_LT(largest / kDegree, 6);
  }
}

TEST(Trajectory, SeedsDifferOnlyInRandomPart) {
  FlightConfig config;
  const Eigen::Vector3d one = make_trajectory(config, 1).at(33).world_from_body.translation;
  EXPECT_EQ((one - make_trajectory(config, 1).at(33).world_from_body.translation).norm(), 0);
  EXPECT_GT((one - make_trajectory(config, 2).at(33).world_from_body.translation).norm(), 0.01);
  config.sway_m = 0;
  EXPECT_LT((make_trajectory(config, 1).at(33).world_from_body.translation -
             make_trajectory(config, 2).at(33).world_from_body.translation)
                .norm(),
            1e-12);
}

TEST(Trajectory, OutAndBackReversesAtHalfTimeAndReturns) {
  FlightConfig config{.shape = FlightShape::out_and_back, .forward_m = 500, .sway_m = 0};
  const Trajectory trajectory = make_trajectory(config, 3);
  const Eigen::Vector3d start(0, 0, 400);
  EXPECT_LT((trajectory.at(75).world_from_body.translation - Eigen::Vector3d(500, 100, 350)).norm(),
            1e-9);
  EXPECT_LT(trajectory.at(75).velocity_in_world_m_s.norm(), 1e-9);
  EXPECT_LT((trajectory.at(150).world_from_body.translation - start).norm(), 1e-9);
  EXPECT_LT(trajectory.at(150).velocity_in_world_m_s.norm(), 1e-9);
}

// Without random motion: velocity along the body x axis, radius v / w, zero lateral specific force.
TEST(Trajectory, TurnIsCoordinated) {
  for (const double turn_rate_deg_s : {12.0, -30.0}) {
    FlightConfig config{.shape = FlightShape::turn,
                        .heading_deg = 25,
                        .speed_m_s = 15,
                        .turn_rate_deg_s = turn_rate_deg_s};
    config.sway_m = config.tilt_sway_deg = config.yaw_sway_deg = 0;
    const Trajectory trajectory = make_trajectory(config, 1);
    const double radius_m = 15 / (turn_rate_deg_s * kDegree);
    const Eigen::Vector2d centre =
        radius_m * Eigen::Vector2d(-std::sin(25 * kDegree), std::cos(25 * kDegree));
    for (double t_s = 0; t_s < 40; t_s += 1.7) {
      const MotionState state = trajectory.at(t_s);
      const Eigen::Quaterniond body_from_world = state.world_from_body.rotation.conjugate();
      const Eigen::Vector3d velocity = body_from_world * state.velocity_in_world_m_s;
      EXPECT_NEAR(velocity.x(), 15, 1e-9);
      const Eigen::Vector3d force =
          body_from_world * (state.acceleration_in_world_m_s2 + Eigen::Vector3d(0, 0, 9.80665));
      EXPECT_NEAR(force.y(), 0, 1e-9);
      EXPECT_GT(force.z(), 9.8);
      EXPECT_NEAR((state.world_from_body.translation.head<2>() - centre).norm(), std::abs(radius_m),
                  1e-9);
    }
    EXPECT_LT(trajectory.at(0).world_from_body.translation.head<2>().norm(), 1e-9);
  }
}

TEST(Trajectory, RejectsGroundContactZeroTurnRateAndRestWithoutFlight) {
  EXPECT_THROW((void)make_trajectory({.duration_s = 5, .rest_s = 4.5}, 1), InputError);
  EXPECT_THROW((void)make_trajectory({.climb_m = -399}, 1), InputError);
  EXPECT_THROW((void)make_trajectory({.shape = FlightShape::turn, .turn_rate_deg_s = 0}, 1),
               InputError);
}

}  // namespace
}  // namespace stillkite
