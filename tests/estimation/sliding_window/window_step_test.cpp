#include "estimation/sliding_window/window_step.hpp"

#include <gtest/gtest.h>

#include "estimation/sliding_window/reprojection_errors.hpp"
#include "true_window.hpp"

namespace stillkite {
namespace {

double mean_squared_error(const Window& window) {
  double sum = 0;
  int count = 0;
  ReprojectionErrors errors(window);
  for (const WindowTrack& track : window.tracks) {
    for (std::size_t k = 1; k < track.observations.size(); ++k, ++count) {
      sum += errors.squared(track, track.observations[k]);
    }
  }
  return sum / count;
}

// A large step that images do not show changes nothing in the images.
TEST(WindowStep, AppliesASimilarity) {
  const Window truth = true_window();
  const std::vector<int> offsets = truth.offsets();
  const RigidTransform& first = truth.frames.front().state.world_from_imu;
  const double before = mean_squared_error(truth);
  for (const double change : {-0.4, 0.6}) {
    const Eigen::Vector3d turn(0.08, -0.05, 0.1);
    Eigen::VectorXd step = change * scale_direction(truth);
    step.segment<3>(ExtrinsicsIndex::kLeverArm) =
        change * truth.extrinsics.imu_from_camera.translation;
    for (std::size_t i = 0; i < truth.frames.size(); ++i) {
      const InertialState& state = truth.frames[i].state;
      const Eigen::Vector3d from_first_m = state.world_from_imu.translation - first.translation;
      step.segment<3>(offsets[i] + InertialIndex::kRotation) =
          state.world_from_imu.rotation.conjugate() * turn;
      step.segment<3>(offsets[i] + InertialIndex::kPosition) += turn.cross(from_first_m);
      step.segment<3>(offsets[i] + InertialIndex::kVelocity) =
          change * state.velocity_in_world_m_s + turn.cross(state.velocity_in_world_m_s);
    }
    Window window = truth;
    WindowLinearization linear = linearize(window, whole_window(window));
    static_cast<void>(eliminate_points(linear, 0));
    apply_step(step, linear, window);
    EXPECT_LT(mean_squared_error(window), 2 * before) << change;
    const RigidTransform& moved_first = window.frames.front().state.world_from_imu;
    const RigidTransform& moved = window.frames.back().state.world_from_imu;
    const RigidTransform& last = truth.frames.back().state.world_from_imu;
    EXPECT_NEAR((moved.translation - moved_first.translation).norm(),
                (1 + change) * (last.translation - first.translation).norm(), 1e-9)
        << change;
    EXPECT_NEAR(window.frames.back().state.velocity_in_world_m_s.norm(),
                (1 + change) * truth.frames.back().state.velocity_in_world_m_s.norm(), 1e-9)
        << change;
  }
}

}  // namespace
}  // namespace stillkite
