#pragma once

#include <optional>
#include <span>

#include "evaluation/association.hpp"

namespace stillkite {

struct PositionError {
  double rmse_m = 0;  ///< absolute trajectory error (ATE), 3-D
  double max_m = 0;
  double end_horizontal_m = 0;
  double end_vertical_m = 0;  ///< magnitude
};

/// Absolute error of a trajectory, estimate minus truth, in the world.
struct TrajectoryError {
  std::optional<PositionError> position;  ///< nothing: the estimate has no scale
  double tilt_rmse_rad = 0;               ///< between the two verticals
  double yaw_rmse_rad = 0;                ///< the twist about the vertical of estimate * truth^-1
};
/// Nothing of no pairs.
[[nodiscard]] std::optional<TrajectoryError> trajectory_error(std::span<const PosePair> pairs);

/// Length of the true path through the pairs, m.
[[nodiscard]] double path_length_m(std::span<const PosePair> pairs);

/// Relative pose error (Sturm et al., IROS 2012): of the motions between pairs a step apart,
/// truth^-1 * estimate.
struct RelativeError {
  int count = 0;
  double translation_rmse_m = 0;
  double rotation_rmse_rad = 0;
  double mean_length_m = 0;  ///< of the true path over one step
};
/// Steps of a number of pairs; nothing when there are not that many. `frames` > 0.
[[nodiscard]] std::optional<RelativeError> relative_error_over_frames(
    std::span<const PosePair> pairs, int frames);
/// Steps of a length of the true path; nothing when it is shorter. `distance_m` > 0.
[[nodiscard]] std::optional<RelativeError> relative_error_over_distance(
    std::span<const PosePair> pairs, double distance_m);

}  // namespace stillkite
