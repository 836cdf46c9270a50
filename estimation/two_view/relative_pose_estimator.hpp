#pragma once

#include <span>

#include "estimation/two_view/relative_pose.hpp"
#include "estimation/two_view/relative_pose_config.hpp"

namespace stillkite {

/// Robust relative pose of two views from bearing pairs with outliers (docs/two_view_pose.md).
/// `focal_px` converts the config's pixels to lengths on z = 1.
///
/// Model `plane`: pose of the homography. `rotation_only` and `still`: no direction. `undecided`:
/// the pose is invalid. Non-finite pairs are outliers. Deterministic for equal input.
[[nodiscard]] RelativePoseEstimate estimate_relative_pose(std::span<const BearingPair> pairs,
                                                          double focal_px,
                                                          const RelativePoseConfig& config,
                                                          const RelativePoseHints& hints = {});

}  // namespace stillkite
