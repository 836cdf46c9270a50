#pragma once

#include <vector>

#include "flow/frame.hpp"
#include "navigation/navigator.hpp"
#include "simulation/flight/simulate.hpp"

namespace stillkite::test {

/// A flight whose answer is known.
struct RenderedFlight {
  FlightRecord record;
  std::vector<Frame> frames;

  [[nodiscard]] const RigidTransform& truth(std::size_t frame) const {
    return record.truth[frame].state.world_from_body;
  }
  [[nodiscard]] InitialState start() const { return {truth(0), ScaleSource::initial_height}; }
  [[nodiscard]] Navigator navigator(const NavigatorConfig& config = {},
                                    Mode mode = Mode::recommended) const {
    return {record.camera, record.body_from_camera, config, start(), {.mode = mode}};
  }
};

inline RenderedFlight film(const SimulationConfig& config, const cv::Mat& photograph = {}) {
  RenderedFlight made{record_flight(config), {}};
  film_flight(config, photograph, [&](const Frame& frame) {
    made.frames.push_back({frame.stamp, frame.index, frame.grey.clone()});
  });
  return made;
}

/// A small one: two seconds at 25 frames/s, 640x360, 40 m high, 12 m ahead, 2 m aside, 1 m down,
/// rocking by a degree.
inline SimulationConfig small_flight(int seed) {
  SimulationConfig config;
  config.seed = seed;
  config.camera.width_px = 640;
  config.camera.height_px = 360;
  config.camera.focal_x_px = config.camera.focal_y_px = 400;
  config.camera.centre_x_px = 319.5;
  config.camera.centre_y_px = 179.5;
  config.flight.duration_s = 2;
  config.flight.height_m = 40;
  config.flight.forward_m = 12;
  config.flight.left_m = 2;
  config.flight.climb_m = -1;
  config.flight.sway_m = 0.1;
  config.ground.side_texels = 1500;
  return config;
}

/// The small flight, filmed once for all tests of a program.
inline const RenderedFlight& rendered_flight() {
  static const RenderedFlight flight = film(small_flight(1));
  return flight;
}

/// All frames of the flight through one navigator.
inline std::vector<NavigationEstimate> fly(Navigator navigator, const std::vector<Frame>& frames) {
  std::vector<NavigationEstimate> estimates;
  estimates.reserve(frames.size());
  for (const Frame& frame : frames) estimates.push_back(navigator.step(frame));
  return estimates;
}

}  // namespace stillkite::test
