#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/homography.hpp"
#include "estimation/two_view/relative_pose_config.hpp"

namespace stillkite {

/// Fit of each model simpler than the essential matrix to its inliers.
struct ModelEvidence {
  /// Mean of min(d^2 / s^2, 6) over the pairs, d the transfer error and s the noise: 1.90 for the
  /// true model, at most 6.
  double still = 6, rotation = 6, plane = 6;
  double pairs = 0;
  double floor = 0;  ///< squared systematic error over squared noise
};

/// `sigma`: noise of a coordinate; `floor`: systematic error of a coordinate; both on z = 1.
[[nodiscard]] ModelEvidence evaluate_models(const BearingColumns& inliers,
                                            const Eigen::Quaterniond& rotation,
                                            const Eigen::Matrix3d& plane, double sigma,
                                            double floor);

/// Simplest model that the pairs do not reject (docs/two_view_pose.md).
[[nodiscard]] ViewModel simplest_model(const ModelEvidence& evidence);

/// Selects one of the two motions of a homography. Criteria in order: pairs in front of the camera,
/// consistent vertical, level plane, distance to the prior; level plane and prior together override
/// the vertical. std::nullopt if no criterion decides, or if neither has the pairs in front.
/// `on_plane`: inliers of the homography; other pairs may lie behind the plane.
[[nodiscard]] std::optional<PlaneMotion> resolve_plane(const std::array<PlaneMotion, 2>& hypotheses,
                                                       const BearingColumns& on_plane,
                                                       const RelativePoseHints& hints,
                                                       const RelativePoseConfig& config);

/// Index of the motion with a consistent vertical or a level plane: the criteria of `resolve_plane`
/// without cheirality and without the prior alone.
[[nodiscard]] std::optional<std::size_t> select_over_ground(
    const std::array<PlaneMotion, 2>& hypotheses, const BearingColumns& inliers,
    const RelativePoseHints& hints, const RelativePoseConfig& config);

}  // namespace stillkite
