#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "estimation/two_view/epipolar_error.hpp"
#include "estimation/two_view/homography.hpp"
#include "estimation/two_view/relative_pose_config.hpp"

namespace stillkite {

/// How well each model that is simpler than a scene with depth explains its inliers.
struct ModelEvidence {
  /// Mean of min(d^2 / s^2, 6) over the pairs, d the transfer error and s the noise: 1.90 where the
  /// model holds, 6 where it explains nothing.
  double still = 6, rotation = 6, plane = 6;
  double pairs = 0;
  double floor = 0;  ///< squared, in units of the noise: what systematic error is excused
};

/// `sigma`: noise of a coordinate; `floor`: its systematic part; both on z = 1.
[[nodiscard]] ModelEvidence weigh_models(const BearingColumns& inliers,
                                         const Eigen::Quaterniond& rotation,
                                         const Eigen::Matrix3d& plane, double sigma, double floor);

/// The simplest model that the pairs do not reject: docs/reference_pose.md, "Which model".
[[nodiscard]] ViewModel simplest_model(const ModelEvidence& evidence);

/// Which of the two views that share a homography: the one with the pairs in front, then the one
/// that keeps the vertical, then the one whose plane is level, then the one near the prior; level
/// ground and the prior together outvote the vertical. Nothing where none tells them apart, or
/// neither has the pairs in front.
/// `on_plane`: the pairs that the homography explains; others may well lie behind the plane.
[[nodiscard]] std::optional<PlaneMotion> resolve_plane(const std::array<PlaneMotion, 2>& views,
                                                       const BearingColumns& on_plane,
                                                       const RelativePoseHints& hints,
                                                       const RelativePoseConfig& config);

/// Which of the two keeps the vertical, or has its plane level: as above, without what the pairs in
/// front and the prior alone would say.
[[nodiscard]] std::optional<std::size_t> view_over_ground(const std::array<PlaneMotion, 2>& views,
                                                          const BearingColumns& inliers,
                                                          const RelativePoseHints& hints,
                                                          const RelativePoseConfig& config);

}  // namespace stillkite
