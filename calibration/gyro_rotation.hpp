#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "geometry/time.hpp"

namespace stillkite {

/// Rotation of a gyroscope over an interval: first axes from second axes.
struct GyroRotation {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d by_bias = Eigen::Matrix3d::Zero();    ///< R(b + d) = R(b) exp(by_bias d)
  Eigen::Vector3d by_offset = Eigen::Vector3d::Zero();  ///< R = R exp(by_offset d), both ends later
};

/// Readings of a gyroscope, linear between them.
class GyroReadings {
 public:
  /// Ascending stamps.
  GyroReadings(std::span<const Timestamp> stamps, std::span<const Eigen::Vector3d> rates_rad_s);

  /// Empty outside the log. `offset_s` is added to both times.
  [[nodiscard]] std::optional<GyroRotation> between(Timestamp from, Timestamp to, double offset_s,
                                                    const Eigen::Vector3d& bias_rad_s) const;

 private:
  [[nodiscard]] Eigen::Vector3d at(std::size_t next, double t_s) const;

  Timestamp origin_;
  std::vector<double> t_s_;
  std::vector<Eigen::Vector3d> rates_rad_s_;
};

}  // namespace stillkite
