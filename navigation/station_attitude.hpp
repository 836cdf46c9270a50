#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace stillkite {

/// Attitude of the body in the station's frame where nobody tells how the two headings lie: the
/// first heading is 0. Between the readings of another sensor, and without any, the camera's
/// estimate turns it on.
class StationAttitude {
 public:
  /// station_from_body of a frame; of its estimate, and of a sensor's reading where there is one.
  Eigen::Quaterniond step(const Eigen::Quaterniond& estimated_world_from_body,
                          const std::optional<Eigen::Quaterniond>& read_world_from_body);

 private:
  std::optional<Eigen::Quaterniond> station_from_body_;
  Eigen::Quaterniond estimated_world_from_body_ = Eigen::Quaterniond::Identity();
  std::optional<Eigen::Quaterniond> station_from_read_world_;
};

}  // namespace stillkite
