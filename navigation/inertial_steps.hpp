#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "estimation/fusion/fusion_filter.hpp"
#include "geometry/time.hpp"
#include "navigation/sensor_readings.hpp"

namespace stillkite {

/// Integration steps of the readings in (from, to], in camera axes; each ends at its own stamp.
/// They add up to less than the interval if readings have a gap before them.
/// The last one is extended to `to` over at most 20 ms, because an image falls between two
/// readings. Readings that are not finite or not ascending are skipped.
[[nodiscard]] std::vector<InertialStep> inertial_steps(const std::vector<InertialReading>& readings,
                                                       Timestamp from, Timestamp to,
                                                       const Eigen::Quaterniond& body_from_camera);

}  // namespace stillkite
