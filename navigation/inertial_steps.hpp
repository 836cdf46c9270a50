#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "estimation/fusion/fusion_filter.hpp"
#include "geometry/time.hpp"
#include "navigation/sensor_readings.hpp"

namespace stillkite {

/// The interval's readings, each carrying on to its own stamp, and the last one up to `to` where
/// that is no more than 20 ms later: an image falls between two of them. What they leave open else
/// has none. Readings that are not finite, or out of turn, are left out.
[[nodiscard]] std::vector<InertialStep> inertial_steps(const std::vector<InertialReading>& readings,
                                                       Timestamp from, Timestamp to,
                                                       const Eigen::Quaterniond& body_from_camera);

}  // namespace stillkite
