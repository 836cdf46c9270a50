#include "simulation/hover/hover_estimate_error.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace stillkite {
namespace {

std::optional<double> pose_nees(const Vector6d& error, const Matrix6d& covariance) {
  const Eigen::LDLT<Matrix6d> factors(covariance);
  if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 0)) return std::nullopt;
  return error.dot(factors.solve(error));
}

double sigma_of(const Eigen::Matrix3d& covariance) {
  return std::sqrt(covariance.trace());
}

}  // namespace

EstimateError estimate_error(const NavigationEstimate& estimate,
                             const RigidTransform& body_from_camera,
                             const RigidTransform& world_from_estimate, const CameraTruth& truth) {
  const RigidTransform estimated =
      world_from_estimate * estimate.world_from_body * body_from_camera;
  Vector6d error;
  error << truth.world_from_camera.translation - estimated.translation,
      so3_log(truth.world_from_camera.rotation * estimated.rotation.conjugate());
  EstimateError out{
      .stamp = estimate.stamp,
      .verdict = estimate.verdict,
      .position_error_m = {},
      .velocity_error_m_s = {},
      .rotation_error_rad = error.tail<3>().norm(),
      .position_sigma_m = sigma_of(estimate.pose_covariance.topLeftCorner<3, 3>()),
      .rotation_sigma_rad = sigma_of(estimate.pose_covariance.bottomRightCorner<3, 3>()),
      .pose_nees = {}};
  // the reference estimator measures only the direction of translation
  const bool is_metric =
      estimate.scale != ScaleSource::none && estimate.source != EstimateSource::reference;
  if (!is_metric) return out;
  out.position_error_m = error.head<3>().norm();
  out.velocity_error_m_s =
      (truth.velocity_in_world_m_s - world_from_estimate.rotation * estimate.velocity_in_world_m_s)
          .norm();
  if (estimate.verdict != Verdict::first_frame) {
    out.pose_nees = pose_nees(error, estimate.pose_covariance);
  }
  return out;
}

}  // namespace stillkite
