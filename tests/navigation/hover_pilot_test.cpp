#include "navigation/hover_pilot.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/angle.hpp"
#include "navigation/pilot_step.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/hover/hover_trial.hpp"
#include "simulation/render/develop.hpp"
#include "stabilization/tether_rates.hpp"

namespace stillkite {
namespace {

using Vector3d = Eigen::Vector3d;

constexpr double kHeading_rad = 0.5;
constexpr TetherState kTether{5, 45 * kDegree, 0};

// Open loop: a level drone in the middle of the room; the commands are not executed.
class ShadowFlight {
 public:
  ShadowFlight() : world_(make_hover_world(config_)) {}

  HoldDecision step(const Vector3d& displacement_in_world_m, double yaw_rad, double blur_rad = 0) {
    const RigidTransform opening = pose(displacement_in_world_m, yaw_rad - blur_rad);
    const RigidTransform closing = pose(displacement_in_world_m, yaw_rad + blur_rad);
    const cv::Mat light = world_.renderer.render(
        world_.scene, {.world_from_camera_at_opening = opening * body_from_camera_,
                       .world_from_camera_at_closing = closing * body_from_camera_});
    const Timestamp now = from_seconds(static_cast<double>(frames_) / 30);
    const Frame frame{now, frames_,
                      develop(light, {.noise_grey = 2}, static_cast<std::uint64_t>(frames_))};
    ++frames_;
    return pilot_
        .step(frame, {.now = now,
                      .tether = TetherReading{.stamp = now, .tether = kTether},
                      .station_from_body = std::nullopt,
                      .sensors = {}})
        .decision;
  }

 private:
  static RigidTransform pose(const Vector3d& displacement_in_world_m, double yaw_rad) {
    return {so3_exp({0, 0, kHeading_rad + yaw_rad}), Vector3d(0, 0, 3) + displacement_in_world_m};
  }

  HoverConfig config_;
  HoverWorld world_;
  RigidTransform body_from_camera_ = camera_raised_forward(config_.plant.camera.forward_tilt_deg);
  HoverPilot pilot_{
      config_.plant.camera.lens(),
      body_from_camera_,
      config_.navigator,
      config_.estimator,
      in_shadow_mode(config_.hold),
      {.world_from_body = pose(Vector3d::Zero(), 0), .scale = ScaleSource::initial_height}};
  std::int64_t frames_ = 0;
};

TEST(HoverPilot, IssuesNoCommandForStationaryCamera) {
  ShadowFlight flight;
  for (int i = 0; i < 30; ++i) {
    const HoldDecision decision = flight.step(Vector3d::Zero(), 0);
    EXPECT_EQ(decision.action, HoldAction::hold) << i;
    EXPECT_EQ(decision.reason,
              i == 0 ? HoldReason::displacement_unknown : HoldReason::within_dead_band)
        << i;
  }
}

// Station axes are defined by the initial heading.
TEST(HoverPilot, CommandsReturnToReferencePosition) {
  for (const Vector3d& displacement_in_body_m : {Vector3d(0, 0.4, 0), Vector3d(-0.3, 0, 0.2)}) {
    ShadowFlight flight;
    HoldDecision decision;
    for (int i = 0; i <= 10; ++i) {
      decision = flight.step(so3_exp({0, 0, kHeading_rad}) * (0.1 * i * displacement_in_body_m), 0);
    }
    ASSERT_EQ(decision.action, HoldAction::command);
    const Vector3d return_direction = -displacement_in_body_m.normalized();
    EXPECT_GT(decision.position_error_in_station_m.normalized().dot(return_direction),
              std::cos(5 * kDegree));
    const Vector3d velocity_m_s = velocity_in_station_m_s(kTether, decision.command);
    EXPECT_GT(velocity_m_s.dot(return_direction), 0.1);
  }
}

TEST(HoverPilot, CommandsYawBackToReference) {
  ShadowFlight flight;
  HoldDecision decision;
  for (int i = 0; i <= 10; ++i) decision = flight.step(Vector3d::Zero(), 0.01 * i);
  ASSERT_EQ(decision.action, HoldAction::command);
  EXPECT_NEAR(decision.yaw_error_rad, -0.1, 0.002);
  EXPECT_LT(decision.command.yaw_rate_rad_s, -0.1);
}

// Yaw step of 20 degrees between two frames: the features are associated, the gate rejects three
// frames, then the yaw correction is commanded.
TEST(HoverPilot, AcceptsTwentyDegreeYawStepAfterThreeRejections) {
  for (const double step_rad : {20 * kDegree, -20 * kDegree}) {
    ShadowFlight flight;
    for (int i = 0; i < 5; ++i) (void)flight.step(Vector3d::Zero(), 0);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(flight.step(Vector3d::Zero(), step_rad).reason, HoldReason::estimate_gated) << i;
    }
    const HoldDecision decision = flight.step(Vector3d::Zero(), step_rad);
    EXPECT_EQ(decision.action, HoldAction::command);
    EXPECT_NEAR(decision.yaw_error_rad, -step_rad, 0.005);
  }
}

// Motion blur during the yaw step leaves only chance features; they must not become the reference.
TEST(HoverPilot, IgnoresMotionBlurredImage) {
  for (int step_deg = -20; step_deg <= 20; step_deg += 8) {
    ShadowFlight flight;
    for (int i = 0; i < 3; ++i) (void)flight.step(Vector3d::Zero(), 0);
    const double step_rad = step_deg * kDegree;
    const HoldReason reason = flight.step(Vector3d::Zero(), step_rad, 40 * kDegree).reason;
    EXPECT_TRUE(reason == HoldReason::estimate_lost || reason == HoldReason::estimate_gated);
    HoldDecision decision;
    for (int i = 0; i < 4; ++i) decision = flight.step(Vector3d::Zero(), step_rad);
    EXPECT_NEAR(decision.yaw_error_rad, -step_rad, 0.005) << step_deg;
  }
}

}  // namespace
}  // namespace stillkite
