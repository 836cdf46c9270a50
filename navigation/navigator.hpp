#pragma once

#include <memory>
#include <vector>

#include "flow/frame.hpp"
#include "geometry/camera.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator_config.hpp"
#include "navigation/sensor_readings.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

/// GNSS-denied visual navigation with one camera: estimates pose and velocity of the body from each
/// frame and optional sensor readings, by the configured estimator. One object per flight.
class Navigator {
 public:
  /// `initial`: body pose at the first frame; its camera must be above the ground, z > 0.
  /// Throws InputError if the camera, the initial state or the configuration is invalid.
  Navigator(const Camera& camera, const RigidTransform& body_from_camera,
            const NavigatorConfig& config, const InitialState& initial,
            const EstimatorConfig& estimator = {});
  ~Navigator();
  Navigator(Navigator&&) noexcept;
  Navigator& operator=(Navigator&&) noexcept;

  /// Estimates the state at the frame's stamp. `readings`: sensors since the previous frame.
  /// An unusable image does not throw: its verdict names the cause, and the predicted state is
  /// returned with a larger covariance. Throws InputError unless the image is CV_8UC1 of the
  /// camera's size and its mask has the same size.
  /// The pixels are shared, a keyframe's over many frames: use a new buffer for every image.
  NavigationEstimate step(const Frame& frame, const SensorReadings& readings = {});

  /// Flow vectors of the last frame, for drawing; empty if nothing was measured.
  [[nodiscard]] std::vector<WeightedFlow> flow_vectors() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
