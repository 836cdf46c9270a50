// Minimal library user: one step of the navigator with a camera looking straight down.
#include <iostream>
#include <stillkite/navigation/navigator.hpp>

using stillkite::RigidTransform;

int main() {
  const stillkite::Camera camera{640, 480, 500, 500, 319.5, 239.5};
  const RigidTransform body_from_camera{{0, 1, 0, 0}, {0, 0, 0}};
  const stillkite::InitialState initial{.world_from_body = {.translation = {0, 0, 20}}};
  stillkite::Navigator navigator(camera, body_from_camera, {}, initial);
  const auto estimate = navigator.step({.grey = cv::Mat(480, 640, CV_8UC1, cv::Scalar(90))});
  std::cout << estimate.world_from_body.translation.transpose() << '\n';
  return estimate.verdict == stillkite::Verdict::first_frame ? 0 : 1;
}
