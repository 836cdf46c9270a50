#pragma once

#include <cstdint>
#include <optional>

#include "geometry/fields.hpp"
#include "geometry/time.hpp"
#include "simulation/flight/sensors.hpp"
#include "simulation/hover/hover_readings.hpp"
#include "simulation/hover/tethered_drone.hpp"
#include "simulation/random.hpp"

namespace stillkite {

struct TetherSensorConfig {
  double rate_hz = 50;
  double length_noise_m = 0.003;
  double angle_noise_deg = 0.3;
  double latency_s = 0.005;

  static void fields(auto& self, auto&& field) {
    field("rate_hz", self.rate_hz, Range{0.1, 1000}, "samples a second");
    field("length_noise_m", self.length_noise_m, kNotNegative, "1 sigma of a sample");
    field("angle_noise_deg", self.angle_noise_deg, kNotNegative,
          "of elevation and azimuth, 1 sigma of a sample");
    field("latency_s", self.latency_s, kNotNegative, "from measurement to the controller");
  }
};

/// The IMU's own attitude filter on top of its raw readings.
struct AttitudeSensorConfig {
  double tilt_noise_deg = 0.2;
  double yaw_noise_deg = 0.05;
  double yaw_drift_deg_per_min = 0.5;

  static void fields(auto& self, auto&& field) {
    field("tilt_noise_deg", self.tilt_noise_deg, kNotNegative, "of roll and pitch, 1 sigma");
    field("yaw_noise_deg", self.yaw_noise_deg, kNotNegative, "1 sigma of a sample");
    field("yaw_drift_deg_per_min", self.yaw_drift_deg_per_min, kNotNegative,
          "of its yaw, steady, to a side that the seed chooses");
  }
};

/// Rates come from `imu`, the attitude with the same samples.
struct HoverSensorConfig {
  TetherSensorConfig tether{};
  ImuConfig imu{};
  AttitudeSensorConfig attitude{};
  double height_error_ratio = 0.02;

  static void fields(auto& self, auto&& field) {
    field("tether", self.tether, "encoders of length, elevation and azimuth at the station");
    field("imu", self.imu, "gyroscope and accelerometer");
    field("attitude", self.attitude, "the IMU's attitude");
    field("height_error_ratio", self.height_error_ratio, Range{0, 0.5},
          "of the height over the floor at the start, 1 sigma");
  }
};

/// Between the truth and the controller: all that the controller learns beside images. Every
/// sensor draws from a stream of its own, so that one more reading of one does not change
/// another's.
class HoverSensors {
 public:
  HoverSensors(const HoverSensorConfig& config, std::uint64_t seed);

  /// Those due up to now, all of now. To be called once a step, with steps no longer than the
  /// shortest period, the first at time 0.
  [[nodiscard]] HoverReadings read(const DroneTruth& truth, Timestamp now);

  /// Height over the floor at the start, as it is known.
  [[nodiscard]] double known_height_m(double height_m) const;

 private:
  struct Inertia {
    Timestamp stamp;
    Eigen::Quaterniond world_from_body;
    std::optional<Eigen::Vector3d> velocity_m_s;  // none before the first step
  };

  [[nodiscard]] TetherSample read_tether(const DroneTruth& truth, Timestamp now);
  [[nodiscard]] AttitudeReading read_attitude(const DroneTruth& truth, Timestamp now);
  [[nodiscard]] ImuReading exact_imu(const DroneTruth& truth, Timestamp now);

  HoverSensorConfig config_;
  Random tether_random_;
  Random attitude_random_;
  ImuErrors imu_errors_;
  std::optional<Inertia> last_inertia_;
  double yaw_drift_rad_s_;
  double height_factor_;
  std::int64_t tether_count_ = 0;
  std::int64_t attitude_count_ = 0;
};

}  // namespace stillkite
