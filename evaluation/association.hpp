#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "estimation/twist.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Ground truth; stamps ascend.
struct Truth {
  std::vector<StampedPose> poses;
  std::vector<StampedTwist> twists_in_camera;  ///< may be empty
};

/// Estimated and true pose at one stamp, both world_from_body.
struct PosePair {
  std::size_t index = 0;  ///< index of the estimate
  Timestamp stamp;
  RigidTransform estimate;
  RigidTransform truth;
  bool is_metric = true;  ///< false: the estimate has no metric scale
};

/// Pose at the stamp, interpolated between its two neighbours. std::nullopt if the nearer one is
/// more than `tolerance_s` away.
[[nodiscard]] std::optional<RigidTransform> pose_at(std::span<const StampedPose> poses,
                                                    Timestamp stamp, double tolerance_s);

/// Twist with the nearest stamp; std::nullopt if it is more than `tolerance_s` away.
[[nodiscard]] std::optional<Twist> twist_at(std::span<const StampedTwist> twists, Timestamp stamp,
                                            double tolerance_s);

/// Estimates with a true pose, in their own order.
[[nodiscard]] std::vector<PosePair> associate(std::span<const StampedPose> estimates,
                                              std::span<const StampedPose> truth,
                                              double tolerance_s);

/// Mean twist between two poses, in the camera frame at half the rotation; the velocity is the
/// chord over `dt_s`.
[[nodiscard]] Twist mean_twist(const RigidTransform& world_from_camera_before,
                               const RigidTransform& world_from_camera_after, double dt_s);

}  // namespace stillkite
