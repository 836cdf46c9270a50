#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "estimation/stamped_velocity.hpp"
#include "estimation/twist.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Standard deviation of the truth's own error, per axis.
struct TruthSigma {
  double position_m = 0;
  double attitude_rad = 0;
  double velocity_m_s = 0;
  double angular_rate_rad_s = 0;
};

/// Ground truth; stamps ascend. Each series may be empty.
struct Truth {
  std::vector<StampedPose> poses;
  bool has_attitude = true;  ///< false: only the positions of the poses are known
  std::vector<StampedTwist> twists_in_camera;
  std::vector<StampedVelocity> velocities;
  TruthSigma sigma;
};

/// Estimated and true pose at one stamp, both world_from_body.
struct PosePair {
  std::size_t index = 0;  ///< index of the estimate
  Timestamp stamp;
  RigidTransform estimate;
  RigidTransform truth;
  bool is_metric = true;     ///< false: the estimate has no metric scale
  bool has_attitude = true;  ///< false: estimate or truth has none; both rotations are equal
};

/// Pose at the stamp, interpolated between its two neighbours. std::nullopt if the nearer one is
/// more than `tolerance_s` away.
[[nodiscard]] std::optional<RigidTransform> pose_at(std::span<const StampedPose> poses,
                                                    Timestamp stamp, double tolerance_s);

/// Twist with the nearest stamp; std::nullopt if it is more than `tolerance_s` away.
[[nodiscard]] std::optional<Twist> twist_at(std::span<const StampedTwist> twists, Timestamp stamp,
                                            double tolerance_s);

/// Velocity interpolated as pose_at.
[[nodiscard]] std::optional<Eigen::Vector3d> velocity_at(
    std::span<const StampedVelocity> velocities, Timestamp stamp, double tolerance_s);

/// True velocities at ascending stamps. Each row is the evidence for one stamp only: at a lower
/// rate than that of the estimates most of these have no true velocity.
class VelocityAssociation {
 public:
  /// `tolerance_s`: to the row, where a neighbour is missing.
  VelocityAssociation(std::span<const StampedVelocity> velocities, double tolerance_s);

  /// Velocity by the nearest unused row, at most `max_distance_s` away, and its neighbour across
  /// the stamp: linear over at most 2.5 median intervals of the rows.
  [[nodiscard]] std::optional<Eigen::Vector3d> next(Timestamp stamp, double max_distance_s);

 private:
  std::span<const StampedVelocity> velocities_;
  double tolerance_s_;
  double max_interval_s_ = 0;
  std::size_t unused_ = 0;  // first row that may be used
};

/// Estimates with a true pose, in their own order: by pose_at, and of a sparser truth the estimate
/// nearest to each row, interpolated over at most 2.5 median intervals of the rows.
[[nodiscard]] std::vector<PosePair> associate(std::span<const StampedPose> estimates,
                                              std::span<const StampedPose> truth,
                                              double tolerance_s);

/// Mean twist between two poses, in the camera frame at half the rotation; the velocity is the
/// chord over `dt_s`.
[[nodiscard]] Twist mean_twist(const RigidTransform& world_from_camera_before,
                               const RigidTransform& world_from_camera_after, double dt_s);

}  // namespace stillkite
