#include <gtest/gtest.h>

#include "navigation/navigator.hpp"
#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

class InitialAttitudeError : public testing::TestWithParam<Policy> {};

// Initial tilt error of 5 degrees, within the configured sigma.
TEST_P(InitialAttitudeError, IsGravityAlignedByGround) {
  const test::RenderedFlight& flight = test::rendered_flight();
  NavigatorConfig config;
  config.initial_tilt_sigma_rad = 0.1;
  const Eigen::Quaterniond tilt_error = so3_exp({0.08, -0.05, 0});
  InitialState start = flight.start();
  start.world_from_body.rotation = tilt_error * start.world_from_body.rotation;
  Navigator navigator(flight.record.camera, flight.record.body_from_camera, config, start,
                      {.policy = GetParam()});
  NavigationEstimate last;
  for (const Frame& frame : flight.frames) last = navigator.step(frame);
  const NavigationEstimate aligned = gravity_aligned(last);
  const RigidTransform& truth = flight.truth(flight.frames.size() - 1);
  EXPECT_LT(angle_between_rad(aligned.world_from_body.rotation, truth.rotation), 0.005);
  EXPECT_LT((aligned.world_from_body.translation - truth.translation).norm(), 0.3);
  const Eigen::Vector3d in_body =
      last.world_from_body.rotation.conjugate() * last.velocity_in_world_m_s;
  EXPECT_LT((aligned.world_from_body.rotation * in_body - aligned.velocity_in_world_m_s).norm(),
            1e-9);
}

INSTANTIATE_TEST_SUITE_P(Policies, InitialAttitudeError,
                         testing::Values(Policy::flow, Policy::best, Policy::fused),
                         [](const auto& policy) { return std::string(name_of(policy.param)); });

// An estimator that keeps the given initial attitude reports the gravity alignment separately.
TEST(FusedInitialAttitude, IsKeptAsGiven) {
  const test::RenderedFlight& flight = test::rendered_flight();
  const Eigen::Quaterniond tilt_error = so3_exp({0.08, -0.05, 0});
  InitialState start = flight.start();
  start.world_from_body.rotation = tilt_error * start.world_from_body.rotation;
  Navigator navigator(flight.record.camera, flight.record.body_from_camera, {}, start,
                      {.policy = Policy::fused});
  const NavigationEstimate first = navigator.step(flight.frames[0]);
  EXPECT_LT(angle_between_rad(first.world_from_body.rotation, start.world_from_body.rotation),
            1e-9);
  ASSERT_TRUE(first.gravity_alignment);
  EXPECT_LT(angle_between_rad(first.gravity_alignment->aligned_from_world.rotation, {1, 0, 0, 0}),
            1e-9);
  EXPECT_NEAR(first.gravity_alignment->sigma_rad, NavigatorConfig{}.initial_tilt_sigma_rad, 1e-9);
  EXPECT_FALSE(gravity_aligned(first).gravity_alignment);
}

}  // namespace
}  // namespace stillkite
