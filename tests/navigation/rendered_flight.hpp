#pragma once

#include <cmath>
#include <vector>

#include "flow/frame.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator.hpp"
#include "simulation/flight/simulate.hpp"

namespace stillkite::test {

/// Rendered frames with ground truth.
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

inline RenderedFlight render_flight(const SimulationConfig& config,
                                    const cv::Mat& photograph = {}) {
  RenderedFlight flight{record_flight(config), {}};
  render_flight(config, photograph, [&](const Frame& frame) {
    flight.frames.push_back({frame.stamp, frame.index, frame.grey.clone()});
  });
  return flight;
}

/// Small flight: 2 s at 25 frames/s, 640x360 px, 40 m high; 12 m forward, 2 m left, 1 m down, with
/// attitude oscillations of one degree.
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

/// The small flight, rendered once per test program.
inline const RenderedFlight& rendered_flight() {
  static const RenderedFlight flight = render_flight(small_flight(1));
  return flight;
}

/// Runs a navigator over all frames.
inline std::vector<NavigationEstimate> fly(Navigator navigator, const std::vector<Frame>& frames) {
  std::vector<NavigationEstimate> estimates;
  estimates.reserve(frames.size());
  for (const Frame& frame : frames) estimates.push_back(navigator.step(frame));
  return estimates;
}

[[nodiscard]] inline bool is_finite(const NavigationEstimate& e) {
  return e.world_from_body.translation.allFinite() &&
         e.world_from_body.rotation.coeffs().allFinite() && e.pose_covariance.allFinite() &&
         e.twist_in_camera.vector().allFinite() && e.twist_covariance.allFinite() &&
         e.velocity_in_world_m_s.allFinite() && std::isfinite(e.quality.mean_flow_px) &&
         std::isfinite(e.quality.residual_px) && std::isfinite(e.quality.condition) &&
         std::isfinite(e.quality.inlier_ratio) && std::isfinite(e.scale_age_s);
}

}  // namespace stillkite::test
