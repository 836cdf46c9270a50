#include <gtest/gtest.h>

#include <cmath>

#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

SimulationConfig rolling_camera(int width_px, int height_px, double focal_px, double readout_s) {
  SimulationConfig config;
  config.camera.width_px = width_px;
  config.camera.height_px = height_px;
  config.camera.focal_x_px = config.camera.focal_y_px = focal_px;
  config.camera.centre_x_px = 0.5 * (width_px - 1);
  config.camera.centre_y_px = 0.5 * (height_px - 1);
  config.camera.readout_s = readout_s;
  config.camera.noise_grey = 1;
  return config;
}

// Constant speed of 5 m/s at 20 m height.
SimulationConfig fast_flight() {
  SimulationConfig config = rolling_camera(480, 360, 400, 0.04);
  config.flight.duration_s = 1.5;
  config.flight.height_m = 20;
  config.flight.shape = FlightShape::turn;
  config.flight.speed_m_s = 5;
  config.flight.turn_rate_deg_s = 20;
  config.flight.sway_m = 0;
  config.ground.side_texels = 1500;
  return config;
}

// Climb from 0.16 m to 0.5 m in one second.
SimulationConfig steep_climb() {
  SimulationConfig config = rolling_camera(320, 240, 350, 0.016);
  config.camera.frames_per_s = 60;
  config.flight.duration_s = 1;
  config.flight.height_m = 0.16;
  config.flight.forward_m = 0.1;
  config.flight.left_m = 0.05;
  config.flight.climb_m = 0.34;
  config.flight.sway_m = 0.01;
  config.ground.metres_per_texel = 0.0005;
  config.ground.side_texels = 2000;
  return config;
}

struct FlightErrors {
  double end_error_m = 0;
  double end_tilt_error_rad = 0;
  double speed_rmse_m_s = 0;
};

FlightErrors flight_errors(const test::RenderedFlight& flight, double readout_s) {
  Navigator navigator = flight.navigator({.readout_s = readout_s});
  NavigationEstimate last;
  double squared = 0;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    last = navigator.step(flight.frames[i]);
    if (i == 0) continue;
    const Twist& truth = flight.record.twists_in_camera[i - 1].twist;
    squared += (last.twist_in_camera.velocity_m_s - truth.velocity_m_s).squaredNorm();
  }
  EXPECT_EQ(last.verdict, Verdict::ok);
  const RigidTransform truth = flight.truth(flight.frames.size() - 1);
  const Eigen::Vector3d up = last.world_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  return {(last.world_from_body.translation - truth.translation).norm(),
          (truth.rotation * up).head<2>().norm(),
          std::sqrt(squared / static_cast<double>(flight.frames.size()))};
}

// The first keyframe, taken before the velocity is estimated, is corrected, too.
TEST(RollingShutter, IsCorrectedFromFirstFrame) {
  const test::RenderedFlight flight = test::render_flight(fast_flight());
  constexpr double kPathLength_m = 7.5;
  const double with = flight_errors(flight, 0.04).end_error_m;
  EXPECT_LT(with, 0.005 * kPathLength_m);
  EXPECT_GT(flight_errors(flight, 0).end_error_m, 5 * with);
}

// In a climb, row delays mimic a tilted ground, and a velocity error feeds back through the next
// frame's rows.
TEST(RollingShutter, CorrectionIsStableInSteepClimb) {
  const test::RenderedFlight flight = test::render_flight(steep_climb());
  const FlightErrors with = flight_errors(flight, 0.016), without = flight_errors(flight, 0);
  EXPECT_LT(with.end_tilt_error_rad, 0.001);
  EXPECT_GT(without.end_tilt_error_rad, 0.02);
  EXPECT_LT(with.end_error_m, 0.0005);
  EXPECT_LT(with.speed_rmse_m_s, 0.003);
}

}  // namespace
}  // namespace stillkite
