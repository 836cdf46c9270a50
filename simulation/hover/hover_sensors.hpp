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
    field("rate_hz", self.rate_hz, Range{0.1, 1000}, "sampling rate");
    field("length_noise_m", self.length_noise_m, kNonNegative, "noise of the length, 1 sigma");
    field("angle_noise_deg", self.angle_noise_deg, kNonNegative,
          "noise of elevation and azimuth, 1 sigma");
    field("latency_s", self.latency_s, kNonNegative, "latency from measurement to controller");
  }
};

/// Attitude filter of the IMU.
struct AttitudeSensorConfig {
  double tilt_noise_deg = 0.2;
  double yaw_noise_deg = 0.05;
  double yaw_drift_deg_per_min = 0.5;

  static void fields(auto& self, auto&& field) {
    field("tilt_noise_deg", self.tilt_noise_deg, kNonNegative, "noise of roll and pitch, 1 sigma");
    field("yaw_noise_deg", self.yaw_noise_deg, kNonNegative, "noise of the yaw, 1 sigma");
    field("yaw_drift_deg_per_min", self.yaw_drift_deg_per_min, kNonNegative,
          "constant drift of the yaw; its sign depends on the seed");
  }
};

/// Attitude samples share the rate and stamps of `imu`.
struct HoverSensorConfig {
  TetherSensorConfig tether{};
  ImuConfig imu{};
  AttitudeSensorConfig attitude{};
  double height_error_ratio = 0.02;

  static void fields(auto& self, auto&& field) {
    field("tether", self.tether, "encoders of the tether's length, elevation and azimuth");
    field("imu", self.imu, "gyroscope and accelerometer");
    field("attitude", self.attitude, "attitude filter of the IMU");
    field("height_error_ratio", self.height_error_ratio, Range{0, 0.5},
          "relative error of the initial height over the floor, 1 sigma");
  }
};

/// All sensors of a trial except the camera. Each sensor has its own random stream: its readings do
/// not depend on the other sensors.
class HoverSensors {
 public:
  HoverSensors(const HoverSensorConfig& config, std::uint64_t seed);

  /// Readings due at `now`. Precondition: called once per step from time 0, with steps no longer
  /// than the shortest sampling period.
  [[nodiscard]] HoverReadings read(const DroneTruth& truth, Timestamp now);

  /// Initial height over the floor with the height error.
  [[nodiscard]] double measured_height_m(double height_m) const;

 private:
  struct MotionSample {
    Timestamp stamp;
    Eigen::Quaterniond world_from_body;
    std::optional<Eigen::Vector3d> velocity_m_s;  // nullopt before the first step
  };

  [[nodiscard]] TetherSample read_tether(const DroneTruth& truth, Timestamp now);
  [[nodiscard]] AttitudeReading read_attitude(const DroneTruth& truth, Timestamp now);
  [[nodiscard]] ImuReading exact_imu(const DroneTruth& truth, Timestamp now);

  HoverSensorConfig config_;
  Random tether_random_;
  Random attitude_random_;
  ImuErrors imu_errors_;
  std::optional<MotionSample> last_motion_;
  double yaw_drift_rad_s_;
  double height_factor_;
  std::int64_t tether_count_ = 0;
  std::int64_t attitude_count_ = 0;
};

}  // namespace stillkite
