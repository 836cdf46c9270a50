#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "estimation/twist.hpp"
#include "flow/frame.hpp"
#include "simulation/flight/flight_camera.hpp"
#include "simulation/flight/sensors.hpp"
#include "simulation/flight/simulation_config.hpp"
#include "simulation/flight/trajectory.hpp"

namespace stillkite {

/// Ground truth at a frame's stamp.
struct StampedState {
  Timestamp stamp;
  MotionState state;
};

/// Ground truth and sensor readings of a flight. The first frame is at time 0.
struct FlightRecord {
  Camera camera;
  RigidTransform body_from_camera;
  std::vector<StampedState> truth;             ///< one per frame
  std::vector<StampedTwist> twists_in_camera;  ///< at the middle of each frame interval
  std::vector<ImuReading> imu;
  std::vector<RangeReading> range;
};

/// Simulates ground truth and sensors. Throws InputError for an inconsistent configuration.
[[nodiscard]] FlightRecord record_flight(const SimulationConfig& config);

/// Images of a flight, in any order. `photograph`: CV_8UC1 ground texture, or empty for a
/// procedural one.
class FlightImages {
 public:
  FlightImages(const SimulationConfig& config, const cv::Mat& photograph);

  [[nodiscard]] std::int64_t count() const { return static_cast<std::int64_t>(stamps_.size()); }
  [[nodiscard]] const std::vector<Timestamp>& stamps() const { return stamps_; }

  /// Precondition: 0 <= index < count().
  [[nodiscard]] Frame render(std::int64_t index) const;

 private:
  std::unique_ptr<const SimulationConfig> config_;  // the camera refers to it
  FlightCamera camera_;
  std::vector<Timestamp> stamps_;
};

/// Receives the frames in order; an exception ends the simulation.
using FrameSink = std::function<void(const Frame&)>;

/// Renders all images of the flight; `photograph` as for FlightImages.
void render_flight(const SimulationConfig& config, const cv::Mat& photograph,
                   const FrameSink& sink);

}  // namespace stillkite
