#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "io/dataset/ground_truth.hpp"
#include "io/dataset/sensor_log.hpp"
#include "io/setup/block_statistics.hpp"
#include "io/setup/setup_finding.hpp"

// Questions about the height, by the motion that the flow measures over flat ground. Lengths of the
// flow are proportional to the initial height. Bounds: docs/check.md.

namespace stillkite {

/// A frame that the flow measured without other sensors.
struct FlowMotion {
  Timestamp stamp;
  RigidTransform world_from_body;
  Eigen::Vector3d velocity_in_world = Eigen::Vector3d::Zero();
  double velocity_sigma = 0;  ///< of one axis
};

/// Metres per unit of the flow's lengths, by the specific force f: over each interval dt,
///
///     integral of R f dt = s (v' - v) - g dt + (integral of R dt) b
///
/// with the attitude R and velocity v of the flow; unknown are the scale s, gravity g and the bias
/// b of the accelerometer (0.3 m/s^2 per axis). Nullopt below 8 s, or if the noise of v' - v would
/// reduce s by more than 5 %.
[[nodiscard]] std::optional<BlockEstimate> inertial_scale(std::span<const FlowMotion> flow,
                                                          const TimeSeries<Vector6d>& imu);

/// The same by the displacements of the truth over intervals of half a second. Nullopt below 5 s.
[[nodiscard]] std::optional<BlockEstimate> scale_of_truth(std::span<const FlowMotion> flow,
                                                          const GroundTruth& truth);

/// Initial height against a metric scale. `height_m`: configured or by the sensor; nullopt:
/// unknown. `scale`: metres per unit of the flow, measured by `source`.
[[nodiscard]] SetupFinding height_finding(std::optional<double> height_m,
                                          const std::optional<BlockEstimate>& scale,
                                          const char* source);

/// Height sensor against the flow's change of height.
[[nodiscard]] SetupFinding height_sensor_finding(std::span<const FlowMotion> flow,
                                                 const SensorLog& sensors,
                                                 std::optional<double> configured_height_m);

}  // namespace stillkite
