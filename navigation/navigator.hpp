#pragma once

#include <memory>
#include <vector>

#include "flow/frame.hpp"
#include "geometry/camera.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator_config.hpp"
#include "navigation/sensor_readings.hpp"
#include "navigation/window_flow.hpp"

namespace stillkite {

/// A frame in, the drone's motion out, by the estimator that is chosen. One object a flight.
class Navigator {
 public:
  /// Throws InputError on a camera, start or config that cannot work.
  Navigator(const Camera& camera, const RigidTransform& body_from_camera,
            const NavigatorConfig& config, const InitialState& initial,
            const EstimatorConfig& estimator = {});
  ~Navigator();
  Navigator(Navigator&&) noexcept;
  Navigator& operator=(Navigator&&) noexcept;

  /// Never throws for what an image shows: a bad frame gets a verdict. A frame of another size
  /// than the camera's throws InputError. The pixels are kept by reference, those of a keyframe for
  /// many frames: hand over an image of its own each time (FrameSource does).
  NavigationEstimate step(const Frame& frame, const SensorReadings& readings = {});

  /// What the windows of the last frame saw, to be drawn; empty where nothing was measured.
  [[nodiscard]] std::vector<WindowFlow> windows() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
