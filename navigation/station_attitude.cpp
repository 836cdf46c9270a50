#include "navigation/station_attitude.hpp"

#include "geometry/euler.hpp"

namespace stillkite {
namespace {

Eigen::Quaterniond about_vertical(double yaw_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
}

double heading_rad(const Eigen::Quaterniond& attitude) {
  return to_euler(attitude).yaw_rad;
}

}  // namespace

Eigen::Quaterniond StationAttitude::step(
    const Eigen::Quaterniond& estimated_world_from_body,
    const std::optional<Eigen::Quaterniond>& measured_world_from_body) {
  // 1. Integrate the visual rotation since the last frame; the initial yaw is 0.
  Eigen::Quaterniond next =
      station_from_body_
          ? *station_from_body_ *
                (estimated_world_from_body_.conjugate() * estimated_world_from_body)
          : about_vertical(-heading_rad(estimated_world_from_body)) * estimated_world_from_body;
  // 2. The first reading gives the yaw between the sensor's world and the station.
  if (measured_world_from_body) {
    if (!station_from_sensor_world_) {
      station_from_sensor_world_ =
          about_vertical(heading_rad(next) - heading_rad(*measured_world_from_body));
    }
    next = *station_from_sensor_world_ * *measured_world_from_body;
  }
  estimated_world_from_body_ = estimated_world_from_body;
  station_from_body_ = next.normalized();
  return *station_from_body_;
}

}  // namespace stillkite
