#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "navigation/navigator.hpp"
#include "simulation/simulate.hpp"

namespace stillkite {
namespace {

// A frame is exposed in so many bands of rows, one after the other, all of the time.
constexpr int kBands = 8;

struct RolledFlight {
  FlightRecord record;
  double readout_s = 0;
  std::vector<Frame> frames;  // a stamp is the middle row's

  // Half way between the two instants next to the middle row's.
  [[nodiscard]] RigidTransform truth(std::size_t frame) const {
    const std::size_t middle = kBands * frame + kBands / 2;
    return interpolate(record.truth[middle - 1].state.world_from_body,
                       record.truth[middle].state.world_from_body, 0.5);
  }
};

RolledFlight rolled_flight(SimulationConfig config) {
  const double readout_s = 1 / config.camera.frames_per_s;
  config.camera.frames_per_s *= kBands;
  config.camera.noise_grey = 1;
  RolledFlight rolled{record_flight(config), readout_s, {}};
  const int rows = config.camera.height_px / kBands;
  cv::Mat picture(config.camera.height_px, config.camera.width_px, CV_8U);
  Timestamp stamp;
  film_flight(config, {}, [&](const Frame& frame) {
    const int band = static_cast<int>(frame.index % kBands);
    const cv::Range range(band * rows, (band + 1) * rows);
    frame.grey.rowRange(range).copyTo(picture.rowRange(range));
    if (band == kBands / 2) {
      stamp = from_seconds(to_seconds(frame.stamp) - 0.5 * readout_s / kBands);
    }
    if (band != kBands - 1) return;
    rolled.frames.push_back({stamp, frame.index / kBands, picture.clone()});
  });
  return rolled;
}

// At 5 m/s from the first frame on, 20 m high.
RolledFlight fast_flight() {
  SimulationConfig config;
  config.camera.frames_per_s = 25;
  config.camera.width_px = 480;
  config.camera.height_px = 360;
  config.camera.focal_x_px = config.camera.focal_y_px = 400;
  config.camera.centre_x_px = 239.5;
  config.camera.centre_y_px = 179.5;
  config.flight.duration_s = 1.5;
  config.flight.height_m = 20;
  config.flight.shape = FlightShape::turn;
  config.flight.speed_m_s = 5;
  config.flight.turn_rate_deg_s = 20;
  config.flight.sway_m = 0;
  config.ground.side_texels = 1500;
  return rolled_flight(config);
}

// From 16 cm to half a metre in a second.
RolledFlight steep_climb() {
  SimulationConfig config;
  config.camera.frames_per_s = 60;
  config.camera.width_px = 320;
  config.camera.height_px = 240;
  config.camera.focal_x_px = config.camera.focal_y_px = 350;
  config.camera.centre_x_px = 159.5;
  config.camera.centre_y_px = 119.5;
  config.flight.duration_s = 1;
  config.flight.height_m = 0.16;
  config.flight.forward_m = 0.1;
  config.flight.left_m = 0.05;
  config.flight.climb_m = 0.34;
  config.flight.sway_m = 0.01;
  config.ground.metres_per_texel = 0.0005;
  config.ground.side_texels = 2000;
  return rolled_flight(config);
}

struct Flown {
  double end_error_m = 0;
  double end_tilt_error_rad = 0;
  double speed_rmse_m_s = 0;
};

Flown flown(const RolledFlight& flight, double readout_s) {
  Navigator navigator(flight.record.camera, flight.record.body_from_camera,
                      {.readout_s = readout_s}, {flight.truth(0), ScaleSource::initial_height});
  NavigationEstimate last;
  double squared = 0;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    last = navigator.step(flight.frames[i]);
    if (i == 0) continue;
    const Eigen::Vector3d way = flight.truth(i).translation - flight.truth(i - 1).translation;
    squared += (last.velocity_in_world_m_s - way / flight.readout_s).squaredNorm();
  }
  EXPECT_EQ(last.verdict, Verdict::ok);
  const RigidTransform truth = flight.truth(flight.frames.size() - 1);
  const Eigen::Vector3d up = last.world_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  return {(last.world_from_body.translation - truth.translation).norm(),
          (truth.rotation * up).head<2>().norm(),
          std::sqrt(squared / static_cast<double>(flight.frames.size()))};
}

// The first keyframe is taken before any speed is known; its rows are late all the same.
TEST(RollingShutter, IsUndoneFromTheFirstFrameOn) {
  const RolledFlight flight = fast_flight();
  ASSERT_GT(flight.frames.size(), 30u);
  constexpr double kWay_m = 7.5;
  const double with = flown(flight, flight.readout_s).end_error_m;
  EXPECT_LT(with, 0.005 * kWay_m);
  EXPECT_GT(flown(flight, 0).end_error_m, 5 * with);
}

// Rows that are late in a climb look like a ground that is tilted, and a speed that is wrong by as
// much as the frame's is fed back by the next one's rows.
TEST(RollingShutter, NeitherTiltsNorShakesASteepClimb) {
  const RolledFlight flight = steep_climb();
  ASSERT_GT(flight.frames.size(), 50u);
  const Flown with = flown(flight, flight.readout_s), without = flown(flight, 0);
  EXPECT_LT(with.end_tilt_error_rad, 0.005);
  EXPECT_GT(without.end_tilt_error_rad, 0.03);
  EXPECT_LT(with.end_error_m, 0.003);
  EXPECT_LT(with.speed_rmse_m_s, 0.01);
}

}  // namespace
}  // namespace stillkite
