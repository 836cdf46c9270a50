#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "navigation/hover_pilot.hpp"
#include "simulation/hover/hover_readings.hpp"

namespace stillkite {

/// The controller's side of the sensors: what has arrived.
class SensorBuffer {
 public:
  /// At take-off the drone stands on its station: their headings are known to each other.
  explicit SensorBuffer(const Eigen::Quaterniond& station_from_world_at_start)
      : station_from_world_(station_from_world_at_start) {}

  void take(const HoverReadings& readings);

  /// With the image of this instant, which the IMU stamps.
  [[nodiscard]] const Eigen::Quaterniond& attitude() const { return attitude_; }

  /// Beside an image of that stamp and attitude, for a command now. Inertial readings are handed
  /// out once, but for the one during which it was taken: cut there, and again with the next.
  [[nodiscard]] TetheredReadings readings(Timestamp stamp, const Eigen::Quaterniond& attitude,
                                          Timestamp now);

 private:
  [[nodiscard]] std::optional<TetherReading> latest_tether(Timestamp now);
  [[nodiscard]] std::vector<InertialReading> take_inertial(Timestamp until);

  Eigen::Quaterniond station_from_world_;
  std::deque<TetherSample> tether_;
  std::deque<InertialReading> inertial_;
  Eigen::Quaterniond attitude_ = Eigen::Quaterniond::Identity();
};

}  // namespace stillkite
