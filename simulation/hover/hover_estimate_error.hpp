#pragma once

#include <optional>

#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// By how much one image's estimate missed the truth at its exposure.
struct EstimateError {
  Timestamp stamp;
  Verdict verdict = Verdict::first_frame;
  /// Of the camera's place as seen from the start; nothing where the estimate has no metres.
  std::optional<double> position_error_m;
  std::optional<double> velocity_error_m_s;  ///< nothing where the estimate has no metres
  double rotation_error_rad = 0;
  /// As the estimate's covariance has them: square roots of its traces.
  double position_sigma_m = 0;
  double rotation_sigma_rad = 0;
  /// Six degrees of freedom; nothing of the first frame, without metres, or where the covariance is
  /// not positive definite.
  std::optional<double> pose_nees;
};

/// The camera as it really was at the exposure.
struct CameraTruth {
  RigidTransform world_from_camera;
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
};

/// `world_from_estimate` lays the estimate's world, which begins at the start as it is known, over
/// the true one. NEES = e^T P^-1 e (Bar-Shalom et al., 2001, eq. 5.4.2-1), e = (c - c', log(R
/// R'^T)) from the estimated pose (R', c') to the true one, both in world as P is.
[[nodiscard]] EstimateError estimate_error(const NavigationEstimate& estimate,
                                           const RigidTransform& body_from_camera,
                                           const RigidTransform& world_from_estimate,
                                           const CameraTruth& truth);

}  // namespace stillkite
