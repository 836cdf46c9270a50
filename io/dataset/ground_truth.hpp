#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "estimation/stamped_velocity.hpp"
#include "estimation/twist.hpp"
#include "geometry/rigid_transform.hpp"
#include "io/config/input_config.hpp"
#include "io/dataset/euroc_dataset.hpp"

namespace stillkite {

/// Number of rows of a file, with the first and last stamp.
struct RowSpan {
  std::size_t rows = 0;
  Timestamp first;
  Timestamp last;

  [[nodiscard]] double duration_s() const { return seconds_between(first, last); }
};

[[nodiscard]] RowSpan row_span(const auto& series) {
  if (series.empty()) return {};
  return {.rows = series.size(), .first = series.front().stamp, .last = series.back().stamp};
}

/// Each series may be empty.
struct GroundTruth {
  std::vector<StampedPose> poses;  ///< world_from_body, ground at z = 0
  bool has_attitude = true;        ///< false: only the positions of the poses are known
  std::vector<StampedTwist> twists_in_camera;
  std::vector<StampedVelocity> velocities;

  [[nodiscard]] bool empty() const {
    return poses.empty() && twists_in_camera.empty() && velocities.empty();
  }
};

/// Rows of the poses, else of the velocities.
[[nodiscard]] RowSpan rows_of(const GroundTruth& truth);

/// Adds the velocities of a file: 4 columns in the world, as read_velocities, or 7 columns in the
/// camera, as read_twists.
[[nodiscard]] GroundTruth with_velocities(GroundTruth truth, const std::filesystem::path& file);

/// Adds `offset_s` to all stamps.
[[nodiscard]] GroundTruth with_time_offset(GroundTruth truth, double offset_s);

/// Ground truth of the configuration, else of the data set; empty without either. Throws InputError
/// as find_trajectory, read_trajectory and read_twists.
[[nodiscard]] GroundTruth read_ground_truth(const TruthConfig& config,
                                            const std::optional<EurocDataset>& dataset);

}  // namespace stillkite
