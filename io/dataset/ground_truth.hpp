#pragma once

#include <optional>
#include <vector>

#include "estimation/twist.hpp"
#include "geometry/rigid_transform.hpp"
#include "io/config/input_config.hpp"
#include "io/dataset/euroc_dataset.hpp"

namespace stillkite {

struct GroundTruth {
  std::vector<StampedPose> poses;              ///< world_from_body, ground at z = 0
  std::vector<StampedTwist> twists_in_camera;  ///< camera frame; may be empty
};

/// Ground truth of the configuration, else of the data set; empty without either. Throws InputError
/// as find_trajectory, read_trajectory and read_twists.
[[nodiscard]] GroundTruth read_ground_truth(const TruthConfig& config,
                                            const std::optional<EurocDataset>& dataset);

}  // namespace stillkite
