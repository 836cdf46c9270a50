// Minimal library user: one step of the navigator with a camera looking straight down.
#include <iostream>
#include <stillkite/stillkite.hpp>
#include <vector>

using stillkite::RigidTransform;

int main() {
  const stillkite::Camera camera{640, 480, 500, 500, 319.5, 239.5};
  const RigidTransform body_from_camera{{0, 1, 0, 0}, {0, 0, 0}};
  const stillkite::InitialState initial{.world_from_body = {.translation = {0, 0, 20}},
                                        .scale = stillkite::ScaleSource::initial_height};
  stillkite::Navigator navigator(camera, body_from_camera, {}, initial);
  const std::vector<std::uint8_t> pixels(640 * 480, 90);
  const stillkite::Estimate estimate = navigator.step({pixels.data(), 640, 480, 640}, {});
  std::cout << estimate.metric.value().position_in_world_m.transpose() << '\n';
  return estimate.verdict == stillkite::Verdict::first_frame ? 0 : 1;
}
