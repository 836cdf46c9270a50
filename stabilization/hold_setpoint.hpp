#pragma once

#include <optional>

#include "estimation/motion_estimate.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Pose to hold, if it is not the estimator's reference pose: a camera pose in the reference frame.
class HoldSetpoint {
 public:
  /// Sets the estimate's pose as the one to hold. False, and no change, unless the estimate is
  /// measured and its displacement is metric or zero.
  [[nodiscard]] bool move_to(const MotionEstimate& estimate);

  /// The estimate relative to the pose to hold (s) instead of the reference (r), p_s in r:
  /// R_sc = R_sr R_rc, c_s = R_sr (c_r - p_s). Without a metric displacement c_r it is unknown.
  /// The covariances are rotated; that of p_s is not added. Unchanged before the first `move_to`.
  [[nodiscard]] MotionEstimate relative(const MotionEstimate& estimate) const;

 private:
  std::optional<RigidTransform> reference_from_setpoint_;
};

}  // namespace stillkite
