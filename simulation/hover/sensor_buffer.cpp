#include "simulation/hover/sensor_buffer.hpp"

namespace stillkite {

void SensorBuffer::add(const HoverReadings& readings) {
  for (const TetherSample& sample : readings.tether) tether_.push_back(sample);
  for (const AttitudeReading& reading : readings.attitude) {
    attitude_ = reading.world_from_body;
    inertial_.push_back(
        {reading.stamp, reading.angular_rate_in_body_rad_s, reading.specific_force_in_body_m_s2});
  }
}

TetheredReadings SensorBuffer::readings(Timestamp stamp, const Eigen::Quaterniond& attitude,
                                        Timestamp now) {
  return {.now = now,
          .tether = latest_tether(now),
          .station_from_body = station_from_world_ * attitude,
          .sensors = {.attitude = attitude, .inertial = take_inertial(stamp)}};
}

std::optional<TetherReading> SensorBuffer::latest_tether(Timestamp now) {
  while (tether_.size() > 1 && tether_[1].available <= now) tether_.pop_front();
  if (tether_.empty() || tether_.front().available > now) return std::nullopt;
  const TetherSample& latest = tether_.front();
  return TetherReading{latest.stamp, latest.tether, latest.taut};
}

std::vector<InertialReading> SensorBuffer::take_inertial(Timestamp until) {
  std::vector<InertialReading> taken;
  while (!inertial_.empty() && inertial_.front().stamp <= until) {
    taken.push_back(inertial_.front());
    inertial_.pop_front();
  }
  if (!inertial_.empty()) {
    taken.push_back(inertial_.front());
    taken.back().stamp = until;
  }
  return taken;
}

}  // namespace stillkite
