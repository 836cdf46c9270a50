#pragma once

#include <optional>
#include <span>

#include "evaluation/association.hpp"

namespace stillkite {

struct EndError {
  double horizontal_m = 0;
  double vertical_m = 0;  ///< absolute value
};

/// Position error over the metric pairs; at least two.
struct PositionError {
  double rmse_m = 0;  ///< absolute trajectory error (ATE), 3-D
  double max_m = 0;
  std::optional<EndError> end;  ///< empty if the last pair is not metric
};

struct AttitudeError {
  double tilt_rmse_rad = 0;  ///< angle between the two verticals
  double yaw_rmse_rad = 0;   ///< twist of estimate * truth^-1 about the vertical
};

/// Absolute error of a trajectory, estimate minus truth, in the world.
struct TrajectoryError {
  std::optional<PositionError> position;  ///< empty with fewer than two metric pairs
  std::optional<AttitudeError> attitude;  ///< empty if estimate or truth has no attitude
};
/// std::nullopt with fewer than two pairs: the error of one frame is no figure of a trajectory.
[[nodiscard]] std::optional<TrajectoryError> trajectory_error(std::span<const PosePair> pairs);

/// Length of the true path through the pairs, m.
[[nodiscard]] double path_length_m(std::span<const PosePair> pairs);

/// Relative pose error (Sturm et al., IROS 2012): truth^-1 * estimate of the motions over one step.
/// Only steps between two metric pairs count. Without attitude the displacements are compared in
/// the world.
struct RelativeError {
  int count = 0;
  double translation_rmse_m = 0;
  std::optional<double> rotation_rmse_rad;  ///< empty if estimate or truth has no attitude
  double mean_length_m = 0;                 ///< mean true path length of a step
};
/// Steps of `frames` > 0 pairs; std::nullopt without a step.
[[nodiscard]] std::optional<RelativeError> relative_error_over_frames(
    std::span<const PosePair> pairs, int frames);
/// Steps of `distance_m` > 0 along the true path; std::nullopt without a step.
[[nodiscard]] std::optional<RelativeError> relative_error_over_distance(
    std::span<const PosePair> pairs, double distance_m);

}  // namespace stillkite
