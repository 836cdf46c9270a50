#include "simulation/hover/hover_sensors.hpp"

#include <algorithm>
#include <utility>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"

namespace stillkite {
namespace {

enum SensorStream : std::uint64_t { kTether = 1, kAttitude, kErrors, kDriftSign, kHeight };

Timestamp due(std::int64_t count, double rate_hz) {
  return from_seconds(static_cast<double>(count) / rate_hz);
}

Timestamp later(Timestamp stamp, double by_s) {
  return {stamp.ns + from_seconds(by_s).ns};
}

}  // namespace

HoverSensors::HoverSensors(const HoverSensorConfig& config, std::uint64_t seed)
    : config_(config),
      tether_random_(seed, kTether),
      attitude_random_(seed, kAttitude),
      imu_errors_(config.imu, Random(seed, kErrors).bits()),
      yaw_drift_rad_s_(config.attitude.yaw_drift_deg_per_min * kDegree / 60 *
                       (Random(seed, kDriftSign).uniform() < 0.5 ? -1 : 1)),
      height_factor_(1 + config.height_error_ratio * Random(seed, kHeight).normal()) {}

HoverReadings HoverSensors::read(const DroneTruth& truth, Timestamp now) {
  HoverReadings readings;
  if (due(tether_count_, config_.tether.rate_hz) <= now) {
    ++tether_count_;
    readings.tether.push_back(read_tether(truth, now));
  }
  if (due(attitude_count_, config_.imu.rate_hz) <= now) {
    ++attitude_count_;
    readings.attitude.push_back(read_attitude(truth, now));
  }
  return readings;
}

TetherSample HoverSensors::read_tether(const DroneTruth& truth, Timestamp now) {
  const TetherSensorConfig& sensor = config_.tether;
  const double angle_noise_rad = sensor.angle_noise_deg * kDegree;
  TetherState measured = truth.tether;
  measured.length_m += sensor.length_noise_m * tether_random_.normal();
  measured.elevation_rad += angle_noise_rad * tether_random_.normal();
  measured.azimuth_rad += angle_noise_rad * tether_random_.normal();
  return {now, later(now, sensor.latency_s), measured, truth.tether_status == TetherStatus::taut};
}

AttitudeReading HoverSensors::read_attitude(const DroneTruth& truth, Timestamp now) {
  const AttitudeSensorConfig& sensor = config_.attitude;
  const EulerAngles true_angles = to_euler(truth.world_from_body.rotation);
  const double yaw_noise_rad = sensor.yaw_noise_deg * kDegree * attitude_random_.normal();
  const double pitch_noise_rad = sensor.tilt_noise_deg * kDegree * attitude_random_.normal();
  const double roll_noise_rad = sensor.tilt_noise_deg * kDegree * attitude_random_.normal();
  const ImuReading raw = imu_errors_.add_to(exact_imu(truth, now));
  return {.stamp = now,
          .world_from_body = to_quaternion(
              {.yaw_rad = true_angles.yaw_rad + yaw_drift_rad_s_ * to_seconds(now) + yaw_noise_rad,
               .pitch_rad = true_angles.pitch_rad + pitch_noise_rad,
               .roll_rad = true_angles.roll_rad + roll_noise_rad}),
          .angular_rate_in_body_rad_s = raw.angular_rate_in_body_rad_s,
          .specific_force_in_body_m_s2 = raw.specific_force_in_body_m_s2};
}

// Mean angular rate and specific force since the previous reading, like a sensor with an
// anti-aliasing filter: no motion between two readings is lost. The velocity step at time 0 is not
// measured.
ImuReading HoverSensors::exact_imu(const DroneTruth& truth, Timestamp now) {
  const Eigen::Quaterniond& attitude = truth.world_from_body.rotation;
  const Eigen::Vector3d& velocity_m_s = truth.velocity_in_world_m_s;
  const MotionSample last = last_motion_.value_or(MotionSample{now, attitude, {}});
  last_motion_ = {now, attitude, last_motion_ ? std::optional(velocity_m_s) : std::nullopt};
  const double dt_s = std::max(seconds_between(last.stamp, now), 1e-9);
  const Eigen::Vector3d acceleration_m_s2 =
      (velocity_m_s - last.velocity_m_s.value_or(velocity_m_s)) / dt_s;
  return {now, so3_log(last.world_from_body.conjugate() * attitude) / dt_s,
          last.world_from_body.slerp(0.5, attitude).conjugate() *
              (acceleration_m_s2 - gravity_in_world_m_s2())};
}

double HoverSensors::measured_height_m(double height_m) const {
  return height_factor_ * height_m;
}

}  // namespace stillkite
