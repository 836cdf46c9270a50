#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "geometry/angle.hpp"
#include "simulation/flight/flight_camera.hpp"
#include "simulation/flight/flight_streams.hpp"

namespace stillkite {
namespace {

SimulationConfig hovering(double relief_m) {
  SimulationConfig config;
  config.camera.width_px = config.camera.height_px = 160;
  config.camera.focal_x_px = config.camera.focal_y_px = 120;
  config.camera.centre_x_px = config.camera.centre_y_px = 79.5;
  config.camera.supersampling = 1;
  config.flight = {.duration_s = 1, .height_m = 30, .forward_m = 0, .left_m = 0, .climb_m = 0};
  config.flight.sway_m = 0;
  config.ground.side_texels = 512;
  config.ground.relief = {.amplitude_m = relief_m, .correlation_length_m = 60};
  return config;
}

// Point of the ground under a bearing: fixed-point iteration over its height.
Eigen::Vector3d ground_point(const RigidTransform& world_from_camera, const Relief* relief,
                             const Eigen::Vector3d& bearing) {
  const Eigen::Vector3d ray = world_from_camera.rotation * bearing;
  const Eigen::Vector3d& camera = world_from_camera.translation;
  Eigen::Vector3d point = camera - camera.z() / ray.z() * ray;
  for (int step = 0; relief && step < 50; ++step) {
    point = camera + (relief->height_m(point.x(), point.y()) - camera.z()) / ray.z() * ray;
  }
  return point;
}

// Reference: distance of the sun's ray through a ground point from the centre of the aircraft.
void expect_shadow_of(const SimulationConfig& config, double penumbra_m) {
  SimulationConfig without = config;
  without.shadow.reset();
  const cv::Mat lit = FlightCamera(without, {}).expose(0).sum;
  const cv::Mat shaded = FlightCamera(config, {}).expose(0).sum;
  const auto relief = make_relief(config);
  const RigidTransform world_from_body =
      make_trajectory(config.flight, flight_seed(config.seed, FlightStream::flight))
          .at(0)
          .world_from_body;
  const RigidTransform world_from_camera = world_from_body * config.camera.body_from_camera();
  const double elevation = config.shadow->sun_elevation_deg * kDegree;
  const double azimuth = config.shadow->sun_azimuth_deg * kDegree;
  const Eigen::Vector3d to_sun(std::cos(elevation) * std::cos(azimuth),
                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  int shaded_pixels = 0;
  for (int row = 0; row < lit.rows; ++row) {
    for (int column = 0; column < lit.cols; ++column) {
      const Eigen::Vector3d bearing((column - 79.5) / 120, (row - 79.5) / 120, 1);
      const Eigen::Vector3d point = ground_point(world_from_camera, relief.get(), bearing);
      const double distance_m = (world_from_body.translation - point).cross(to_sun).norm();
      const double size_m = config.shadow->size_m;
      const double inner_m = 0.5 * (size_m - penumbra_m);
      const double share = std::clamp(1 - (distance_m - inner_m) / penumbra_m, 0.0, 1.0);
      const double expected = 1 - config.shadow->darkening_ratio * share;
      EXPECT_NEAR(shaded.at<float>(row, column) / lit.at<float>(row, column), expected, 0.01)
          << column << ", " << row;
      shaded_pixels += share == 1;
    }
  }
  EXPECT_GT(shaded_pixels, 20);
}

TEST(Shadow, LiesWhereSunRayThroughAircraftMeetsGround) {
  SimulationConfig config = hovering(0);
  config.shadow = AircraftShadowConfig{
      .size_m = 3, .darkening_ratio = 0.6, .sun_elevation_deg = 65, .sun_azimuth_deg = 30};
  // 30 m / sin(65 deg) at the sun's angular diameter of 0.0093 rad
  expect_shadow_of(config, 0.0093 * 30 / std::sin(65 * kDegree));
}

TEST(Shadow, FollowsRelief) {
  SimulationConfig config = hovering(3);
  config.shadow = AircraftShadowConfig{
      .size_m = 3, .darkening_ratio = 0.6, .sun_elevation_deg = 65, .sun_azimuth_deg = 120};
  expect_shadow_of(config, 0.0093 * 30 / std::sin(65 * kDegree));
}

// At height h a ball smaller than the sun's image covers (size / w)^2 of the sun.
TEST(Shadow, FadesWithHeight) {
  SimulationConfig config = hovering(0);
  config.flight.height_m = 400;
  config.flight.tilt_sway_deg = config.flight.yaw_sway_deg = 0;
  const cv::Mat lit = FlightCamera(config, {}).expose(0).sum;
  config.shadow =
      AircraftShadowConfig{.size_m = 2, .darkening_ratio = 0.8, .sun_elevation_deg = 90};
  const cv::Mat shaded = FlightCamera(config, {}).expose(0).sum;
  // the centre is between four pixels, 2.4 m from each: at r of the ramp |2 - w| / 2 to (2 + w) / 2
  const double sun_m = 0.0093 * 400;
  const double radius_m = std::sqrt(0.5) * 400 / 120;
  const double share = (0.5 * (2 + sun_m) - radius_m) / 2;
  EXPECT_NEAR(shaded.at<float>(79, 79) / lit.at<float>(79, 79),
              1 - 0.8 * std::pow(2 / sun_m, 2) * share, 1e-3);
}

}  // namespace
}  // namespace stillkite
