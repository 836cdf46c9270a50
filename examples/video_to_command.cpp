// Position hold from a video: for each image, the tether command that returns the drone to its
// initial position. Camera of configs/simulate_demo.yaml, 20 m above ground, 15 m tether at 60 deg.
#include <cstdio>
#include <exception>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stillkite/stillkite.hpp>

using namespace stillkite;

namespace {

/// Nadir camera, image top towards the nose. Columns: image right, image down and optical axis in
/// the body frame (x forward, y left, z up).
RigidTransform camera_on_body() {
  Eigen::Matrix3d body_from_camera;
  body_from_camera << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  return {Eigen::Quaterniond(body_from_camera), Eigen::Vector3d::Zero()};
}

void print(const Estimate& estimate, const HoldDecision& decision) {
  std::printf("%7.3f s  %s by %s", to_seconds(estimate.stamp), name_of(estimate.verdict).data(),
              name_of(estimate.source).data());
  if (estimate.metric) {
    const Eigen::Vector3d& at_m = estimate.metric->position_in_world_m;
    std::printf(", at %6.2f %6.2f %6.2f m", at_m.x(), at_m.y(), at_m.z());
  }
  const TetherCommand& c = decision.command;
  std::printf(": %s (%s), reel %+.3f m/s, elevation %+.3f, azimuth %+.3f, yaw %+.3f rad/s\n",
              name_of(decision.action).data(), name_of(decision.reason).data(), c.length_rate_m_s,
              c.elevation_rate_rad_s, c.azimuth_rate_rad_s, c.yaw_rate_rad_s);
}

}  // namespace

int main(int argc, char** argv) try {
  cv::VideoCapture video(argc == 2 ? argv[1] : "");
  const double frames_per_s = video.get(cv::CAP_PROP_FPS);
  if (!(frames_per_s > 0)) return std::fputs("usage: video_to_command FLIGHT.mp4\n", stderr), 2;
  const Camera camera{640, 480, 480, 480, 319.5, 239.5};
  const InitialState initial{.world_from_body = {.translation = {0, 0, 20}},
                             .scale = ScaleSource::initial_height};
  // shadow mode: a recorded drone does not execute commands
  HoverPilot pilot(camera, camera_on_body(), {}, {.policy = Policy::best}, in_shadow_mode({}),
                   initial);
  cv::Mat colour, grey;
  for (int i = 0; video.read(colour); ++i) {
    cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
    const Timestamp stamp = from_seconds(i / frames_per_s);
    const TetherReading tether{stamp, {15, std::numbers::pi / 3, 0}};
    const ImageView image{grey.data, grey.cols, grey.rows, static_cast<std::ptrdiff_t>(grey.step)};
    const HoldStep step = pilot.step(image, stamp, {.now = stamp, .tether = tether});
    print(step.estimate, step.decision);
  }
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "video_to_command: %s\n", error.what()), 1;
}
