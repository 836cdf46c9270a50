#pragma once

#include <span>

#include "estimation/two_view/opencv_pose_config.hpp"
#include "estimation/two_view/relative_pose.hpp"

namespace stillkite {

/// Relative pose by OpenCV as in the hold paper, section III: findEssentialMat, correctMatches,
/// recoverPose. The model is `general`, or `undecided` if OpenCV finds no matrix; the covariance is
/// 0. Deterministic: OpenCV seeds its own random generator.
[[nodiscard]] RelativePoseEstimate estimate_relative_pose_opencv(std::span<const BearingPair> pairs,
                                                                 double focal_px,
                                                                 const OpenCvPoseConfig& config);

}  // namespace stillkite
