#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>

#include "io/dataset/sensor_log.hpp"

namespace stillkite {

/// How the body has turned between two images, by what these alone show.
struct SeenTurn {
  Timestamp from;
  Timestamp to;
  Eigen::Vector3d in_body_rad = Eigen::Vector3d::Zero();
};

/// A sentence where the images turn otherwise than the gyroscope and something simple explains
/// it: that it tells next to nothing, degrees for radians, other axes, or another clock. Nothing
/// where the body hardly turned, or where neither explains it.
[[nodiscard]] std::optional<std::string> doubt_of_gyro(const TimeSeries<Eigen::Vector3d>& gyro,
                                                       std::span<const SeenTurn> seen);

}  // namespace stillkite
