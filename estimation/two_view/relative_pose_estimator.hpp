#pragma once

#include <span>

#include "estimation/two_view/relative_pose.hpp"
#include "estimation/two_view/relative_pose_config.hpp"

namespace stillkite {

/// The motion between two views from pairs of bearings of the same features, some of them wrong:
/// docs/reference_pose.md. `focal_px` turns the config's pixels into lengths on z = 1.
///
/// The pose of a plane comes from its homography, rotation only has no direction, stillness
/// neither. `undecided`: the pose is not to be used. Pairs that are not finite count as outliers.
/// Equal input gives an equal answer.
[[nodiscard]] RelativePoseEstimate estimate_relative_pose(std::span<const BearingPair> pairs,
                                                          double focal_px,
                                                          const RelativePoseConfig& config,
                                                          const RelativePoseHints& hints = {});

}  // namespace stillkite
