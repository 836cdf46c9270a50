#include <gtest/gtest.h>

#include "estimation/plane/keyframe_pose.hpp"
#include "navigation/keyframe_navigator.hpp"
#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

// A start that is believed level and leans by ten degrees: the flow keeps its normal, and to first
// order its windows tell neither turn nor way for another one.
TEST(KeyframeView, TellsTheMotionForTheNormalThatIsHintedAt) {
  constexpr double kLean_rad = 0.17;
  constexpr std::size_t kFrames = 12;
  const test::RenderedFlight& flight = test::rendered_flight();
  const auto camera_at = [&](std::size_t frame) {
    return flight.truth(frame) * flight.record.body_from_camera;
  };
  InitialState believed = flight.start();
  believed.world_from_body.rotation =
      so3_exp({kLean_rad, 0, 0}) * believed.world_from_body.rotation;
  const PlaneMotion truth = motion_between(camera_at(0), camera_at(kFrames));
  const auto turn_error_rad = [&](const FlowHints& hints) {
    KeyframeNavigator navigator(flight.record.camera, flight.record.body_from_camera,
                                {.initial_tilt_sigma_rad = 1e-4}, believed);
    FrameClock clock(1);
    for (std::size_t i = 0; i <= kFrames; ++i) {
      const NavigationEstimate estimate =
          navigator.step(flight.frames[i], clock.pass(flight.frames[i]), {}, hints);
      EXPECT_FALSE(i > 0 && estimate.new_keyframe) << i;
    }
    const KeyframeView view = navigator.view().value();
    const Eigen::Vector2d turn =
        view.tilt_axes.transpose() * view.motion.normal.cross(truth.normal);
    PlaneMotionStep to_normal;
    to_normal << view.windows.motion_by_tilt * turn, turn;
    const PlaneMotion seen = apply(view.motion, to_normal, view.tilt_axes);
    return angle_between_rad(seen.rotation, truth.rotation);
  };
  EXPECT_LT(turn_error_rad({.may_search = true, .normal = truth.normal}), 1e-4);
  EXPECT_GT(turn_error_rad({}), 1e-3);
  // what no alignment suits is left as it was
  const Eigen::Vector3d nonsense = so3_exp({0.9, 0, 0}) * truth.normal;
  EXPECT_EQ(turn_error_rad({.may_search = true, .normal = nonsense}), turn_error_rad({}));
}

}  // namespace
}  // namespace stillkite
