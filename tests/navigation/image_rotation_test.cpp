#include "navigation/image_rotation.hpp"

#include <gtest/gtest.h>

#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

// A gyroscope with the opposite sign is the initial value of the alignments, no evidence.
TEST(ImageRotation, IsThatOfTheImagesWithAWrongGyroscope) {
  const test::RenderedFlight& flight = test::rendered_flight();
  Navigator navigator = flight.navigator();
  const auto camera_at = [&](std::size_t i) {
    return flight.truth(i).rotation * flight.record.body_from_camera.rotation;
  };
  Eigen::Vector3d error_sum = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
  int count = 0, keyframes = 0;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    SensorReadings readings;
    Eigen::Vector3d rate_in_camera_rad_s = Eigen::Vector3d::Zero();
    if (i > 0) {
      const double dt_s = seconds_between(flight.frames[i - 1].stamp, flight.frames[i].stamp);
      rate_in_camera_rad_s = so3_log(camera_at(i - 1).conjugate() * camera_at(i)) / dt_s;
      readings.mean_angular_rate_in_body_rad_s =
          -(flight.record.body_from_camera.rotation * rate_in_camera_rad_s);
    }
    const NavigationEstimate estimate = navigator.step(flight.frames[i], readings);
    keyframes += estimate.new_keyframe ? 1 : 0;
    const auto& measured = estimate.measured_rate_in_camera_rad_s;
    if (!measured) continue;
    ++count;
    error_sum += (*measured - rate_in_camera_rad_s).cwiseAbs2();
    sum += rate_in_camera_rad_s.cwiseAbs2();
  }
  EXPECT_GT(keyframes, 1);
  EXPECT_EQ(count + 1, std::ssize(flight.frames));
  EXPECT_LT(error_sum.norm(), 0.1 * 0.1 * sum.norm());
}

}  // namespace
}  // namespace stillkite
