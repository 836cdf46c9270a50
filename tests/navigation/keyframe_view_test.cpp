#include <gtest/gtest.h>

#include "estimation/plane/keyframe_pose.hpp"
#include "navigation/keyframe_navigator.hpp"
#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

// Initial attitude error of ten degrees with a small sigma: the flow keeps its normal, and rotation
// and translation for another normal are wrong to first order.
TEST(KeyframeView, IsLinearizedAtHintedNormal) {
  constexpr double kTiltError_rad = 0.17;
  constexpr std::size_t kFrames = 12;
  const test::RenderedFlight& flight = test::rendered_flight();
  const auto camera_at = [&](std::size_t frame) {
    return flight.truth(frame) * flight.record.body_from_camera;
  };
  InitialState initial = flight.start();
  initial.world_from_body.rotation =
      so3_exp({kTiltError_rad, 0, 0}) * initial.world_from_body.rotation;
  const PlaneMotion truth = motion_between(camera_at(0), camera_at(kFrames));
  const auto rotation_error_rad = [&](const FlowHints& hints) {
    KeyframeNavigator navigator(flight.record.camera, flight.record.body_from_camera,
                                {.initial_tilt_sigma_rad = 1e-4}, initial);
    FrameClock clock(1);
    for (std::size_t i = 0; i <= kFrames; ++i) {
      const NavigationEstimate estimate =
          navigator.step(flight.frames[i], clock.check(flight.frames[i]), {}, hints);
      EXPECT_FALSE(i > 0 && estimate.new_keyframe) << i;
    }
    const KeyframeView view = navigator.view().value();
    const Eigen::Vector2d tilt_rad =
        view.tilt_axes.transpose() * view.motion.normal.cross(truth.normal);
    PlaneMotionStep to_normal;
    to_normal << view.likelihood.motion_by_tilt * tilt_rad, tilt_rad;
    const PlaneMotion measured = apply(view.motion, to_normal, view.tilt_axes);
    return angle_between_rad(measured.rotation, truth.rotation);
  };
  EXPECT_LT(rotation_error_rad({.allow_search = true, .normal = truth.normal}), 1e-4);
  EXPECT_GT(rotation_error_rad({}), 1e-3);
  // a normal that no alignment fits is ignored
  const Eigen::Vector3d wrong_normal = so3_exp({0.9, 0, 0}) * truth.normal;
  EXPECT_EQ(rotation_error_rad({.allow_search = true, .normal = wrong_normal}),
            rotation_error_rad({}));
}

}  // namespace
}  // namespace stillkite
