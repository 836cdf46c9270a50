#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "estimation/twist.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// What an estimate is judged by. The stamps ascend.
struct Truth {
  std::vector<StampedPose> poses;
  std::vector<StampedTwist> twists_in_camera;  ///< may be empty
};

/// An estimated pose and the true one at its stamp, both world_from_body.
struct PosePair {
  std::size_t index = 0;  ///< of the estimate
  Timestamp stamp;
  RigidTransform estimate;
  RigidTransform truth;
  bool is_metric = true;  ///< false: the estimate's lengths are not metres
};

/// Pose at the stamp, interpolated between its two neighbours; nothing when the nearer of them is
/// more than `tolerance_s` away.
[[nodiscard]] std::optional<RigidTransform> pose_at(std::span<const StampedPose> poses,
                                                    Timestamp stamp, double tolerance_s);

/// Nearest twist; nothing when it is more than `tolerance_s` away.
[[nodiscard]] std::optional<Twist> twist_at(std::span<const StampedTwist> twists, Timestamp stamp,
                                            double tolerance_s);

/// The estimates that have a truth, in their own order.
[[nodiscard]] std::vector<PosePair> associate(std::span<const StampedPose> estimates,
                                              std::span<const StampedPose> truth,
                                              double tolerance_s);

/// Mean motion from one pose to the next, in the camera half way between them (chord of the
/// path, half of the rotation).
[[nodiscard]] Twist mean_twist(const RigidTransform& world_from_camera_before,
                               const RigidTransform& world_from_camera_after, double dt_s);

}  // namespace stillkite
