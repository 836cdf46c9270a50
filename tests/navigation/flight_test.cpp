#include <gtest/gtest.h>

#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

using test::fly;
using test::rendered_flight;

constexpr double kFlown_m = 12.2;

class EveryMode : public testing::TestWithParam<Mode> {};

TEST_P(EveryMode, DeadReckonsAFlightWithTheAnswerKnown) {
  const auto& flight = rendered_flight();
  const auto estimates = fly(flight.navigator({}, GetParam()), flight.frames);
  const double allowed = GetParam() == Mode::paper ? 0.03 : 0.002;
  for (std::size_t i = 1; i < estimates.size(); ++i) EXPECT_EQ(estimates[i].verdict, Verdict::ok);
  const RigidTransform& end = estimates.back().world_from_body;
  const RigidTransform& truth = flight.truth(flight.frames.size() - 1);
  EXPECT_LT((end.translation - truth.translation).norm(), allowed * kFlown_m);
  EXPECT_LT(angle_between_rad(end.rotation, truth.rotation), allowed);
}

TEST_P(EveryMode, IsTheSameTwice) {
  const auto& flight = rendered_flight();
  const auto once = fly(flight.navigator({}, GetParam()), flight.frames);
  const auto again = fly(flight.navigator({}, GetParam()), flight.frames);
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].world_from_body.translation, again[i].world_from_body.translation);
    EXPECT_EQ(once[i].twist_in_camera.vector(), again[i].twist_in_camera.vector());
  }
}

// How the camera sits in the body is a matter of names: the camera flies the same way.
TEST_P(EveryMode, CameraDoesNotCareAboutItsMount) {
  const auto& flight = rendered_flight();
  const FlightRecord& record = flight.record;
  const RigidTransform world_from_camera = flight.truth(0) * record.body_from_camera;
  const RigidTransform mount{so3_exp({0.2, -0.1, 1.3}) * record.body_from_camera.rotation,
                             {0.3, -0.2, 0.1}};
  const InitialState start{world_from_camera * mount.inverse(), ScaleSource::initial_height};
  const auto usual = fly(flight.navigator({}, GetParam()), flight.frames).back();
  const auto other =
      fly(Navigator(record.camera, mount, {}, start, {.mode = GetParam()}), flight.frames).back();
  const RigidTransform a = usual.world_from_body * record.body_from_camera;
  const RigidTransform b = other.world_from_body * mount;
  // Euler's steps of other angles differ in second order
  const double allowed = GetParam() == Mode::paper ? 0.02 : 1e-3;
  EXPECT_LT((a.translation - b.translation).norm(), allowed);
  EXPECT_LT(angle_between_rad(a.rotation, b.rotation), allowed);
}

// From images alone lengths are in heights.
TEST_P(EveryMode, TwiceTheHeightIsTwiceTheWay) {
  const auto& flight = rendered_flight();
  InitialState high = flight.start();
  high.world_from_body.translation.z() *= 2;
  const auto usual = fly(flight.navigator({}, GetParam()), flight.frames).back();
  const auto twice = fly(Navigator(flight.record.camera, flight.record.body_from_camera, {}, high,
                                   {.mode = GetParam()}),
                         flight.frames)
                         .back();
  EXPECT_LT((twice.world_from_body.translation - 2 * usual.world_from_body.translation).norm(),
            2e-3 * kFlown_m);
  // the filter's acceleration is in metres: its speeds do not scale exactly
  EXPECT_LT((twice.velocity_in_world_m_s - 2 * usual.velocity_in_world_m_s).norm(), 0.08);
}

INSTANTIATE_TEST_SUITE_P(Navigator, EveryMode, testing::Values(Mode::paper, Mode::recommended),
                         [](const auto& mode) { return std::string(name_of(mode.param)); });

TEST(Navigator, VelocityIsRightOnceItIsLearnt) {
  const auto& flight = rendered_flight();
  const auto estimates = fly(flight.navigator(), flight.frames);
  for (std::size_t i = 25; i < estimates.size(); ++i) {
    const Twist& truth = flight.record.twists_in_camera[i - 1].twist;
    EXPECT_LT((estimates[i].twist_in_camera.velocity_m_s - truth.velocity_m_s).norm(), 0.2);
  }
}

TEST(Navigator, WindowsTellTheFlowSinceTheFrameBefore) {
  const auto& flight = rendered_flight();
  for (const Mode mode : {Mode::paper, Mode::recommended}) {
    Navigator navigator = flight.navigator({}, mode);
    EXPECT_TRUE(navigator.windows().empty());
    const RigidTransform& mount = flight.record.body_from_camera;
    for (std::size_t i = 0; i < 20; ++i) {
      (void)navigator.step(flight.frames[i]);
      if (i < 3) continue;
      const RigidTransform before = flight.truth(i - 1) * mount;
      const RigidTransform now = flight.truth(i) * mount;
      double squared = 0;
      int count = 0;
      for (const WindowFlow& window : navigator.windows()) {
        if (window.weight < 0.5F) continue;
        const Eigen::Vector2d from_px = (window.centre_px - window.flow_px).cast<double>();
        const Eigen::Vector2d bearing = *undistort(flight.record.camera, from_px);
        const Eigen::Vector3d ray = before.rotation * bearing.homogeneous();
        const Eigen::Vector3d point = before.translation - ray * (before.translation.z() / ray.z());
        const auto to_px = project(flight.record.camera, now.inverse() * point);
        squared += (*to_px - window.centre_px.cast<double>()).squaredNorm();
        ++count;
      }
      EXPECT_GT(count, 500);
      EXPECT_LT(std::sqrt(squared / count), mode == Mode::paper ? 0.5 : 0.1) << i;
    }
  }
}

}  // namespace
}  // namespace stillkite
