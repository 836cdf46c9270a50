#include <gtest/gtest.h>

#include <vector>

#include "navigation/navigator.hpp"
#include "simulation/simulate.hpp"

namespace stillkite {
namespace {

// A frame is exposed in so many bands of rows, one after the other, all of the time.
constexpr int kBands = 8;
constexpr double kFrames_per_s = 25;
constexpr double kReadout_s = 1 / kFrames_per_s;

struct RolledFlight {
  FlightRecord record;
  std::vector<Frame> frames;  // a stamp is the middle row's

  // Half way between the two instants next to the middle row's.
  [[nodiscard]] RigidTransform truth(std::size_t frame) const {
    const std::size_t middle = kBands * frame + kBands / 2;
    return interpolate(record.truth[middle - 1].state.world_from_body,
                       record.truth[middle].state.world_from_body, 0.5);
  }
};

// At 5 m/s from the first frame on, 20 m high.
RolledFlight fast_flight() {
  SimulationConfig config;
  config.camera.frames_per_s = kBands * kFrames_per_s;
  config.camera.width_px = 480;
  config.camera.height_px = 360;
  config.camera.focal_x_px = config.camera.focal_y_px = 400;
  config.camera.centre_x_px = 239.5;
  config.camera.centre_y_px = 179.5;
  config.camera.noise_grey = 1;
  config.flight.duration_s = 1.5;
  config.flight.height_m = 20;
  config.flight.shape = FlightShape::turn;
  config.flight.speed_m_s = 5;
  config.flight.turn_rate_deg_s = 20;
  config.flight.sway_m = 0;
  config.ground.side_texels = 1500;
  RolledFlight rolled{record_flight(config), {}};
  const int rows = config.camera.height_px / kBands;
  cv::Mat picture(config.camera.height_px, config.camera.width_px, CV_8U);
  Timestamp before;
  film_flight(config, {}, [&](const Frame& frame) {
    const int band = static_cast<int>(frame.index % kBands);
    const cv::Range range(band * rows, (band + 1) * rows);
    frame.grey.rowRange(range).copyTo(picture.rowRange(range));
    if (band == kBands / 2) before.ns = frame.stamp.ns - std::int64_t{5'000'000} / 2;
    if (band != kBands - 1) return;
    rolled.frames.push_back({before, frame.index / kBands, picture.clone()});
  });
  return rolled;
}

double end_error_m(const RolledFlight& flight, double readout_s) {
  Navigator navigator(flight.record.camera, flight.record.body_from_camera,
                      {.readout_s = readout_s}, {flight.truth(0), ScaleSource::initial_height});
  NavigationEstimate last;
  for (const Frame& frame : flight.frames) last = navigator.step(frame);
  EXPECT_EQ(last.verdict, Verdict::ok);
  const RigidTransform truth = flight.truth(flight.frames.size() - 1);
  return (last.world_from_body.translation - truth.translation).norm();
}

// The first keyframe is taken before any speed is known; its rows are late all the same.
TEST(RollingShutter, IsUndoneFromTheFirstFrameOn) {
  const RolledFlight flight = fast_flight();
  ASSERT_GT(flight.frames.size(), 30u);
  constexpr double kWay_m = 7.5;
  const double with = end_error_m(flight, kReadout_s);
  EXPECT_LT(with, 0.005 * kWay_m);
  EXPECT_GT(end_error_m(flight, 0), 5 * with);
}

}  // namespace
}  // namespace stillkite
