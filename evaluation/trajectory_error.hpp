#pragma once

#include <optional>
#include <span>

#include "evaluation/association.hpp"

namespace stillkite {

struct EndError {
  double horizontal_m = 0;
  double vertical_m = 0;  ///< magnitude
};

/// Of the pairs in metres.
struct PositionError {
  double rmse_m = 0;  ///< absolute trajectory error (ATE), 3-D
  double max_m = 0;
  std::optional<EndError> end;  ///< nothing: the last pair is in no metres
};

/// Absolute error of a trajectory, estimate minus truth, in the world.
struct TrajectoryError {
  std::optional<PositionError> position;  ///< nothing: no pair is in metres
  double tilt_rmse_rad = 0;               ///< between the two verticals
  double yaw_rmse_rad = 0;                ///< the twist about the vertical of estimate * truth^-1
};
/// Nothing of no pairs.
[[nodiscard]] std::optional<TrajectoryError> trajectory_error(std::span<const PosePair> pairs);

/// Length of the true path through the pairs, m.
[[nodiscard]] double path_length_m(std::span<const PosePair> pairs);

/// Relative pose error (Sturm et al., IROS 2012): of the motions between pairs a step apart,
/// truth^-1 * estimate. Those between pairs of which one is in no metres are left out.
struct RelativeError {
  int count = 0;
  double translation_rmse_m = 0;
  double rotation_rmse_rad = 0;
  double mean_length_m = 0;  ///< of the true path over one step
};
/// Steps of a number of pairs; nothing without one. `frames` > 0.
[[nodiscard]] std::optional<RelativeError> relative_error_over_frames(
    std::span<const PosePair> pairs, int frames);
/// Steps of a length of the true path; nothing without one. `distance_m` > 0.
[[nodiscard]] std::optional<RelativeError> relative_error_over_distance(
    std::span<const PosePair> pairs, double distance_m);

}  // namespace stillkite
