#include <gtest/gtest.h>

#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

using test::fly;
using test::rendered_flight;

constexpr double kPathLength_m = 12.2;

class EveryMode : public testing::TestWithParam<Mode> {};

TEST_P(EveryMode, DeadReckonsRenderedFlight) {
  const auto& flight = rendered_flight();
  const auto estimates = fly(flight.navigator({}, GetParam()), flight.frames);
  const double tolerance = GetParam() == Mode::paper ? 0.03 : 0.002;
  for (std::size_t i = 1; i < estimates.size(); ++i) EXPECT_EQ(estimates[i].verdict, Verdict::ok);
  const RigidTransform& end = estimates.back().world_from_body;
  const RigidTransform& truth = flight.truth(flight.frames.size() - 1);
  EXPECT_LT((end.translation - truth.translation).norm(), tolerance * kPathLength_m);
  EXPECT_LT(angle_between_rad(end.rotation, truth.rotation), tolerance);
}

TEST_P(EveryMode, IsDeterministic) {
  const auto& flight = rendered_flight();
  const auto first = fly(flight.navigator({}, GetParam()), flight.frames);
  const auto second = fly(flight.navigator({}, GetParam()), flight.frames);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].world_from_body.translation, second[i].world_from_body.translation);
    EXPECT_EQ(first[i].twist_in_camera.vector(), second[i].twist_in_camera.vector());
  }
}

// The camera trajectory does not depend on the camera mount.
TEST_P(EveryMode, IsIndependentOfCameraMount) {
  const auto& flight = rendered_flight();
  const FlightRecord& record = flight.record;
  const RigidTransform world_from_camera = flight.truth(0) * record.body_from_camera;
  const RigidTransform mount{so3_exp({0.2, -0.1, 1.3}) * record.body_from_camera.rotation,
                             {0.3, -0.2, 0.1}};
  const InitialState start{world_from_camera * mount.inverse(), ScaleSource::initial_height};
  const auto nominal = fly(flight.navigator({}, GetParam()), flight.frames).back();
  const auto remounted =
      fly(Navigator(record.camera, mount, {}, start, {.mode = GetParam()}), flight.frames).back();
  const RigidTransform a = nominal.world_from_body * record.body_from_camera;
  const RigidTransform b = remounted.world_from_body * mount;
  // Euler integration of different angles differs to second order
  const double tolerance = GetParam() == Mode::paper ? 0.02 : 1e-3;
  EXPECT_LT((a.translation - b.translation).norm(), tolerance);
  EXPECT_LT(angle_between_rad(a.rotation, b.rotation), tolerance);
}

// Monocular scale: lengths are proportional to the initial height.
TEST_P(EveryMode, DisplacementScalesWithHeight) {
  const auto& flight = rendered_flight();
  InitialState high = flight.start();
  high.world_from_body.translation.z() *= 2;
  const auto nominal = fly(flight.navigator({}, GetParam()), flight.frames).back();
  const auto twice = fly(Navigator(flight.record.camera, flight.record.body_from_camera, {}, high,
                                   {.mode = GetParam()}),
                         flight.frames)
                         .back();
  EXPECT_LT((twice.world_from_body.translation - 2 * nominal.world_from_body.translation).norm(),
            2e-3 * kPathLength_m);
  // the filter's acceleration density is metric: velocities do not scale exactly
  EXPECT_LT((twice.velocity_in_world_m_s - 2 * nominal.velocity_in_world_m_s).norm(), 0.08);
}

INSTANTIATE_TEST_SUITE_P(Navigator, EveryMode, testing::Values(Mode::paper, Mode::recommended),
                         [](const auto& mode) { return std::string(name_of(mode.param)); });

TEST(Navigator, VelocityConverges) {
  const auto& flight = rendered_flight();
  const auto estimates = fly(flight.navigator(), flight.frames);
  for (std::size_t i = 25; i < estimates.size(); ++i) {
    const Twist& truth = flight.record.twists_in_camera[i - 1].twist;
    EXPECT_LT((estimates[i].twist_in_camera.velocity_m_s - truth.velocity_m_s).norm(), 0.2);
  }
}

TEST(Navigator, FlowVectorsAreSincePreviousFrame) {
  const auto& flight = rendered_flight();
  for (const Mode mode : {Mode::paper, Mode::recommended}) {
    Navigator navigator = flight.navigator({}, mode);
    EXPECT_TRUE(navigator.flow_vectors().empty());
    const RigidTransform& mount = flight.record.body_from_camera;
    for (std::size_t i = 0; i < 20; ++i) {
      (void)navigator.step(flight.frames[i]);
      if (i < 3) continue;
      const RigidTransform before = flight.truth(i - 1) * mount;
      const RigidTransform now = flight.truth(i) * mount;
      double squared = 0;
      int count = 0;
      for (const WeightedFlow& vector : navigator.flow_vectors()) {
        if (vector.weight < 0.5F) continue;
        const Eigen::Vector2d from_px = (vector.centre_px - vector.flow_px).cast<double>();
        const Eigen::Vector2d bearing = *undistort(flight.record.camera, from_px);
        const Eigen::Vector3d ray = before.rotation * bearing.homogeneous();
        const Eigen::Vector3d point = before.translation - ray * (before.translation.z() / ray.z());
        const auto to_px = project(flight.record.camera, now.inverse() * point);
        squared += (*to_px - vector.centre_px.cast<double>()).squaredNorm();
        ++count;
      }
      EXPECT_GT(count, 500);
      EXPECT_LT(std::sqrt(squared / count), mode == Mode::paper ? 0.5 : 0.1) << i;
    }
  }
}

}  // namespace
}  // namespace stillkite
