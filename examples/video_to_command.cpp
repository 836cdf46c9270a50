// Position hold from a video: for each frame, the tether command that returns the drone to its
// initial position. Camera of configs/simulate_demo.yaml, 20 m above ground, 20 m tether.
#include <cstdio>
#include <exception>
#include <numbers>
#include <stillkite/io/video/frame_source.hpp>
#include <stillkite/navigation/hover_pilot.hpp>

using namespace stillkite;

namespace {

/// Nadir camera, image top towards the nose. Columns: image right, image down and optical axis in
/// the body frame (x forward, y left, z up).
RigidTransform camera_on_body() {
  Eigen::Matrix3d body_from_camera;
  body_from_camera << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  return {Eigen::Quaterniond(body_from_camera), Eigen::Vector3d::Zero()};
}

void print(const PilotStep& step) {
  const Eigen::Vector3d& position_m = step.estimate.world_from_body.translation;
  const TetherCommand& c = step.decision.command;
  std::printf(
      "%7.3f s  %s by %s, at %6.2f %6.2f %6.2f m: %s, reel %+.3f m/s, elevation %+.3f, "
      "azimuth %+.3f, yaw %+.3f rad/s\n",
      to_seconds(step.estimate.stamp), name_of(step.estimate.verdict).data(),
      name_of(step.estimate.source).data(), position_m.x(), position_m.y(), position_m.z(),
      name_of(step.decision.action).data(), c.length_rate_m_s, c.elevation_rate_rad_s,
      c.azimuth_rate_rad_s, c.yaw_rate_rad_s);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: video_to_command FLIGHT.mp4\n");
    return 2;
  }
  FrameSource video({.path = argv[1]});
  const Camera camera{640, 480, 480, 480, 319.5, 239.5};
  const InitialState initial{.world_from_body = {.translation = {0, 0, 20}},
                             .scale = ScaleSource::initial_height};
  // shadow mode: a recorded drone does not execute commands
  HoverPilot pilot(camera, camera_on_body(), {}, {.policy = Policy::best}, in_shadow_mode({}),
                   initial);
  while (const std::optional<Frame> frame = video.next()) {
    const TetherReading tether{frame->stamp, {20, std::numbers::pi / 3, 0}};
    print(pilot.step(*frame, {.now = frame->stamp, .tether = tether}));
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "video_to_command: %s\n", error.what());
  return 1;
}
