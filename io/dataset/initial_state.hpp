#pragma once

#include "geometry/rigid_transform.hpp"
#include "geometry/time.hpp"
#include "io/config/run_config.hpp"
#include "io/dataset/ground_truth.hpp"
#include "io/dataset/sensor_log.hpp"
#include "navigation/sensor_readings.hpp"

namespace stillkite {

/// State at the first frame: of the truth with initial.from_truth (its position, if it has no
/// attitude), else attitude and height of the sensors' readings or the configuration; height 1
/// without any. Throws InputError on contradictory
/// keys and a truth that does not cover the first frame.
[[nodiscard]] InitialState initial_state(const RunConfig& config, const GroundTruth& truth,
                                         const SensorLog& sensors, Timestamp first);

}  // namespace stillkite
