#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "live/clock/clock_map.hpp"
#include "live/live_config.hpp"
#include "live/sensor_samples.hpp"

namespace stillkite {

/// Version of the sensor lines.
inline constexpr int kSensorSchema = 1;

/// Readings of a JSON line, in the body's axes (forward, left, up); each is optional:
///
///     {"schema": 1, "timestamp": 1700000000000, "angular_rate": [0, 0, 0.1],
///      "specific_force": [0, 0, 9.81], "attitude": [1, 0, 0, 0], "range": 2.5, "height": 3}
struct SensorLine {
  struct Imu {
    Eigen::Vector3d angular_rate_in_body_rad_s, specific_force_in_body_m_s2;
  };
  std::optional<std::int64_t> sender_ns;  ///< timestamp: ns since any epoch
  std::optional<Imu> imu;
  std::optional<Eigen::Quaterniond> world_from_body;  ///< attitude w, x, y, z; world: z up
  std::optional<double> range_m;                      ///< along the body's -z
  std::optional<double> height_m;                     ///< relative
};

/// A line, or the reason why it is none.
struct ParsedSensorLine {
  std::optional<SensorLine> line;
  std::string problem;
};

/// A line is rejected as a whole: without the schema, with an unknown key, without a reading, with
/// a value of another type or out of range, and with one half of an IMU reading.
[[nodiscard]] ParsedSensorLine parse_sensor_line(std::string_view text);

/// Gives the readings of one sender's lines their stamps on the local clock: the timestamp, mapped
/// by the smallest delay (ClockMap), or the arrival of a line without one.
class SensorLineReader {
 public:
  explicit SensorLineReader(const TelemetryConfig& config) : config_(config) {}

  /// Readings that the configuration uses and that are newer than the last of their kind.
  [[nodiscard]] std::vector<SensorSample> read(const SensorLine& line, Timestamp arrival);

 private:
  TelemetryConfig config_;
  ClockMap clock_;
  std::optional<Timestamp> last_imu_, last_attitude_, last_height_;
};

}  // namespace stillkite
