#pragma once

#include <optional>

#include "app/fly_config.hpp"
#include "io/dataset/flight_inputs.hpp"
#include "live/mavlink/telemetry.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/navigator.hpp"

namespace stillkite {

/// Estimator of a live flight, in flight and from its record: the same telemetry and frames in the
/// same order give the same estimates.
class FlightEstimator {
 public:
  explicit FlightEstimator(FlyConfig config);

  /// Adds a packet of the autopilot.
  void receive(const mavlink::Packet& packet, Timestamp arrival);

  /// False before the first frame while telemetry that defines the initial state is missing.
  [[nodiscard]] bool is_ready(Timestamp stamp) const;

  /// True once the readings of IMU and attitude reach the stamp. Those of a sensor that is absent,
  /// silent or slower than 20 Hz are not expected.
  [[nodiscard]] bool has_telemetry_until(Timestamp stamp) const;

  /// Estimate of a frame, gravity-aligned. The first frame sets the initial state. Throws
  /// InputError on an invalid calibration or initial state.
  [[nodiscard]] NavigationEstimate step(const Frame& frame);

  /// Valid after the first frame.
  [[nodiscard]] const FlightInputs& inputs() const { return *inputs_; }
  /// With the navigator's effective configuration after the first frame.
  [[nodiscard]] const FlyConfig& config() const { return config_; }

 private:
  void add(const mavlink::SensorSample& sample);
  void initialize(const Frame& first);
  void discard_before(Timestamp oldest);

  FlyConfig config_;
  mavlink::Telemetry telemetry_;
  Eigen::Quaterniond body_from_autopilot_;
  SensorLog sensors_;                     // last seconds
  std::optional<Timestamp> oldest_kept_;  // telemetry of a flight without frames
  double height_offset_m_ = 0;
  std::optional<FlightInputs> inputs_;
  std::optional<Navigator> navigator_;
  std::optional<Timestamp> last_frame_;
};

}  // namespace stillkite
