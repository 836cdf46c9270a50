#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "geometry/angle.hpp"
#include "stabilization/hold_controller.hpp"
#include "stabilization/hold_errors.hpp"
#include "stabilization/tether_rates.hpp"
#include "tests/stabilization/hold_scene.hpp"

namespace stillkite {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using std::numbers::pi;

class RandomScene {
 public:
  double in(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vector3d direction() { return Vector3d(in(-1, 1), in(-1, 1), in(-1, 1)).normalized(); }
  Quaterniond rotation(double max_rad) { return so3_exp(in(0, max_rad) * direction()); }
  Quaterniond camera() { return so3_exp({0, 0, in(-pi, pi)}) * forward_camera() * rotation(0.6); }

 private:
  std::mt19937 random_{3};
};

HoldConfig without_dead_band(HoldMode mode) {
  HoldConfig config{.mode = mode};
  config.recommended.position.dead_band = 0;
  config.recommended.yaw.dead_band = 0;
  return config;
}

HoldDecision decide_once(const HoldConfig& config, const MotionEstimate& estimate,
                         const TetherState& tether, const Quaterniond& station_from_camera) {
  HoldController controller(config);
  return controller.decide({.estimate = estimate,
                            .tether = TetherReading{.tether = tether},
                            .station_from_camera = station_from_camera});
}

TEST(HoldGeometry, EstimateTransformsScenePoints) {
  RandomScene random;
  const RigidTransform reference{random.camera(), {0, 0, 2}};
  const RigidTransform camera{random.camera(), {0.3, -0.2, 2.1}};
  const MotionEstimate e = exact_estimate(reference, camera);
  for (int k = 0; k < 20; ++k) {
    const Vector3d point = 5 * random.direction();
    const Vector3d in_camera = camera.inverse() * point;
    const Vector3d in_reference = reference.inverse() * point;
    const Quaterniond camera_from_reference = e.reference_from_camera.conjugate();
    EXPECT_LT(
        (in_camera - camera_from_reference * (in_reference - e.displacement_in_reference)).norm(),
        1e-12);
  }
}

TEST(HoldGeometry, PositionErrorPointsToReferenceAtAnyAttitude) {
  RandomScene random;
  for (int k = 0; k < 2000; ++k) {
    const RigidTransform reference{random.camera(), 5 * random.direction()};
    const RigidTransform camera{random.camera(), 5 * random.direction()};
    const Vector3d error =
        position_error_in_station(exact_estimate(reference, camera), camera.rotation);
    ASSERT_LT((error - (reference.translation - camera.translation)).norm(), 1e-12);
  }
}

TEST(HoldGeometry, YawErrorIsMinusTheYawRotation) {
  RandomScene random;
  for (int k = 0; k < 2000; ++k) {
    const double left_rad = random.in(-pi, pi);
    const RigidTransform reference{random.camera(), {0, 0, 2}};
    const RigidTransform camera{so3_exp({0, 0, left_rad}) * reference.rotation, {0, 0, 2}};
    ASSERT_NEAR(yaw_error_rad(exact_estimate(reference, camera), camera.rotation), -left_rad, 1e-9);
  }
}

TEST(HoldGeometry, PaperThetaYIsYawOfLevelCamera) {
  for (const double left_rad : {-1.2, -0.1, 0.2, 1.0}) {
    const RigidTransform reference{forward_camera(), {0, 0, 2}};
    const RigidTransform camera{so3_exp({0, 0, left_rad}) * forward_camera(), {0, 0, 2}};
    const EulerAngles angles = paper_angles(exact_estimate(reference, camera));
    EXPECT_NEAR(angles.pitch_rad, left_rad, 1e-12);
    EXPECT_NEAR(angles.roll_rad, 0, 1e-12);
    EXPECT_NEAR(angles.yaw_rad, 0, 1e-12);
    for (const HoldMode mode : {HoldMode::paper, HoldMode::recommended}) {
      const HoldDecision decision = decide_once(
          without_dead_band(mode), exact_estimate(reference, camera), {5, 1, 0}, camera.rotation);
      EXPECT_LT(decision.command.yaw_rate_rad_s * left_rad, 0);
    }
  }
}

TEST(HoldGeometry, RecommendedModeMovesStraightToReference) {
  RandomScene random;
  int exact = 0;
  for (int k = 0; k < 5000; ++k) {
    TetherState tether{random.in(1, 18), random.in(0.2, pi - 0.2), random.in(-4, 4)};
    // the tether model initializes at the zenith
    if (position_in_station(tether).head<2>().norm() < 0.5) tether = {tether.length_m, pi / 2, 0};
    const Vector3d displacement = random.in(0.001, 1.5) * random.direction();
    const RigidTransform camera{random.camera(), position_in_station(tether)};
    const RigidTransform reference{
        so3_exp({0, 0, random.in(-0.3, 0.3)}) * camera.rotation * random.rotation(0.2),
        camera.translation - displacement};
    const HoldDecision decision =
        decide_once(without_dead_band(HoldMode::recommended), exact_estimate(reference, camera),
                    tether, camera.rotation);
    if (decision.reason == HoldReason::angle_first) continue;
    const Vector3d velocity = velocity_in_station_m_s(tether, decision.command);
    ASSERT_EQ(decision.action, HoldAction::command);
    ASSERT_GT(velocity.dot(-displacement), 0);
    const bool free = std::abs(decision.command.length_rate_m_s) < 0.3 &&
                      std::abs(decision.command.elevation_rate_rad_s) < 0.25 &&
                      std::abs(decision.command.azimuth_rate_rad_s) < 0.2 &&
                      displacement.norm() < 0.5 &&
                      std::abs(tether.length_m * std::cos(tether.elevation_rad)) > 0.5;
    const bool far_from_ends =
        tether.elevation_rad > 0.5 && tether.elevation_rad < pi - 0.5 && tether.length_m > 1.1;
    if (!free || !far_from_ends) continue;
    ASSERT_LT((velocity + 4.4 * displacement).norm(), 1e-9);
    ++exact;
  }
  EXPECT_GT(exact, 300);
}

TEST(HoldGeometry, PaperModeMovesToReferenceByUnitTranslation) {
  RandomScene random;
  for (int k = 0; k < 5000; ++k) {
    const TetherState tether{random.in(4, 18), random.in(0.3, 1.0), random.in(-4, 4)};
    const Vector3d displacement = random.in(0.001, 3) * random.direction();
    const RigidTransform camera{random.camera(), position_in_station(tether)};
    const RigidTransform reference{camera.rotation * random.rotation(4 * kDegree),
                                   camera.translation - displacement};
    MotionEstimate estimate = exact_estimate(reference, camera);
    estimate.displacement_kind = DisplacementKind::direction;
    estimate.displacement_in_reference.normalize();
    const HoldDecision decision =
        decide_once(without_dead_band(HoldMode::paper), estimate, tether, camera.rotation);
    ASSERT_EQ(decision.reason, HoldReason::none);
    ASSERT_NEAR(decision.position_error_in_station_m.norm(), 1, 1e-12);
    // arc of up to 1 m at 4 m or more, each rate limited separately
    const Vector3d velocity = velocity_in_station_m_s(tether, decision.command);
    ASSERT_GT(velocity.normalized().dot(-displacement.normalized()), 0.7);
  }
}

}  // namespace
}  // namespace stillkite
