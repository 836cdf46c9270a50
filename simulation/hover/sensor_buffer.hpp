#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "navigation/hover_pilot.hpp"
#include "simulation/hover/hover_readings.hpp"

namespace stillkite {

/// Sensor readings received by the controller.
class SensorBuffer {
 public:
  /// Station heading relative to the world, available at take-off from the drone on its station.
  explicit SensorBuffer(const Eigen::Quaterniond& station_from_world_at_start)
      : station_from_world_(station_from_world_at_start) {}

  void add(const HoverReadings& readings);

  /// Latest attitude world_from_body of the IMU.
  [[nodiscard]] const Eigen::Quaterniond& attitude() const { return attitude_; }

  /// Readings for a command at `now` from an image with this stamp and attitude. Each inertial
  /// reading is returned once, except the reading whose interval contains `stamp`: it is split at
  /// the stamp, and its remainder is returned with the next image.
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
