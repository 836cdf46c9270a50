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
    const std::optional<Eigen::Quaterniond>& read_world_from_body) {
  // 1. On from the last frame as the camera turned; at the first one the heading is 0.
  Eigen::Quaterniond next =
      station_from_body_
          ? *station_from_body_ *
                (estimated_world_from_body_.conjugate() * estimated_world_from_body)
          : about_vertical(-heading_rad(estimated_world_from_body)) * estimated_world_from_body;
  // 2. A sensor's world has a heading of its own; the first reading tells which.
  if (read_world_from_body) {
    if (!station_from_read_world_) {
      station_from_read_world_ =
          about_vertical(heading_rad(next) - heading_rad(*read_world_from_body));
    }
    next = *station_from_read_world_ * *read_world_from_body;
  }
  estimated_world_from_body_ = estimated_world_from_body;
  station_from_body_ = next.normalized();
  return *station_from_body_;
}

}  // namespace stillkite
