#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "estimation/twist.hpp"
#include "flow/frame.hpp"
#include "simulation/flight/sensors.hpp"
#include "simulation/flight/simulation_config.hpp"
#include "simulation/flight/trajectory.hpp"

namespace stillkite {

/// The truth of a frame's instant.
struct StampedState {
  Timestamp stamp;
  MotionState state;
};

/// Everything of a flight but its images. The first frame is at time 0.
struct FlightRecord {
  Camera camera;
  RigidTransform body_from_camera;
  std::vector<StampedState> truth;             ///< one a frame
  std::vector<StampedTwist> twists_in_camera;  ///< one a frame but the first
  std::vector<ImuReading> imu;
  std::vector<RangeReading> range;
};

/// Truth and sensors. Throws InputError where the configuration makes no sense.
[[nodiscard]] FlightRecord record_flight(const SimulationConfig& config);

/// Is handed every frame in turn; what it throws ends the simulation.
using FrameSink = std::function<void(const Frame&)>;

/// Images of the same flight. `photograph`: CV_8UC1 where the configuration names one, else
/// empty.
void film_flight(const SimulationConfig& config, const cv::Mat& photograph, const FrameSink& sink);

}  // namespace stillkite
