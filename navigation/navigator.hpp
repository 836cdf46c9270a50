#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image_view.hpp"
#include "geometry/time.hpp"
#include "navigation/estimate.hpp"
#include "navigation/navigator_config.hpp"
#include "navigation/sensor_readings.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

struct Frame;
struct InertialFinding;
struct NavigationEstimate;

/// GNSS-denied visual navigation with one camera: estimates pose and velocity of the body from each
/// frame and optional sensor readings, by the configured estimator. One object per flight.
/// Sources: docs/plane_odometry.md, docs/two_view_pose.md and docs/fusion.md, by policy.
class Navigator {
 public:
  /// `initial`: body pose at the first image; its camera must be above the ground, z > 0.
  /// `valid_pixels`: mask, 0 where a pixel does not show the scene; copied, mode paper ignores it.
  /// Throws InputError if camera, mask or initial state is invalid, or keys contradict each other.
  /// The ranges of single keys (`fields`) are checked where YAML is read, not here.
  Navigator(const Camera& camera, const RigidTransform& body_from_camera,
            const NavigatorConfig& config, const InitialState& initial,
            const EstimatorConfig& estimator = {},
            const std::optional<ImageView>& valid_pixels = {});
  ~Navigator();
  Navigator(Navigator&&) noexcept;
  Navigator& operator=(Navigator&&) noexcept;

  /// Estimates the state at `stamp`, the exposure of the image's middle row. `readings`: sensors
  /// since the previous image. The pixels are copied. Stamps of arrival jitter: filter them by
  /// StampFilter, and pass its sigma, which enters the covariances.
  /// An unusable image does not throw: its verdict names the cause, and the predicted state is
  /// returned with a larger covariance. Throws InputError on null data, a stride below the width,
  /// or another size than the camera's.
  Estimate step(const ImageView& image, Timestamp stamp, const SensorReadings& readings = {},
                double stamp_sigma_s = 0);

  /// Internal, for the program `stillkite` (`Frame` is not installed): every internal figure, in
  /// the world of the given initial attitude. Throws InputError unless the image is CV_8UC1 of the
  /// camera's size and its mask has the same size. The pixels are shared, a keyframe's over many
  /// frames: use a new buffer for every image.
  NavigationEstimate step(const Frame& frame, const SensorReadings& readings = {});

  /// Internal: differences of IMU and mount from their calibration, by `fusion.solver: window`.
  [[nodiscard]] std::vector<InertialFinding> inertial_findings() const;

  /// Flow vectors of the last image, for drawing; empty if nothing was measured.
  [[nodiscard]] std::vector<WeightedFlow> flow_vectors() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillkite
