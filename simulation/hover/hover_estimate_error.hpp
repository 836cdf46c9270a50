#pragma once

#include <optional>

#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Error of one image's estimate against ground truth at the exposure.
struct EstimateError {
  Timestamp stamp;
  Verdict verdict = Verdict::first_frame;
  std::optional<double> position_error_m;    ///< of the camera; nullopt without metric scale
  std::optional<double> velocity_error_m_s;  ///< nullopt without metric scale
  double rotation_error_rad = 0;
  /// Square roots of the traces of the estimate's covariance blocks.
  double position_sigma_m = 0;
  double rotation_sigma_rad = 0;
  /// Six degrees of freedom. Nullopt in the first frame, without metric scale, or if the covariance
  /// is not positive definite.
  std::optional<double> pose_nees;
};

/// Ground truth of the camera at the exposure.
struct CameraTruth {
  RigidTransform world_from_camera;
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
};

/// `world_from_estimate`: from the estimator's world, defined by the configured initial state, to
/// the true world. NEES = e^T P^-1 e (Bar-Shalom et al., 2001, eq. 5.4.2-1) with
/// e = (c - c', log(R R'^T)), true pose (R, c), estimate (R', c'); e and P are in the world frame.
[[nodiscard]] EstimateError estimate_error(const NavigationEstimate& estimate,
                                           const RigidTransform& body_from_camera,
                                           const RigidTransform& world_from_estimate,
                                           const CameraTruth& truth);

}  // namespace stillkite
