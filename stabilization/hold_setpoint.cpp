#include "stabilization/hold_setpoint.hpp"

namespace stillkite {
namespace {

bool has_metric_displacement(const MotionEstimate& estimate) {
  return estimate.displacement_kind == DisplacementKind::metric ||
         estimate.displacement_kind == DisplacementKind::zero;
}

}  // namespace

bool HoldSetpoint::move_to(const MotionEstimate& estimate) {
  if (estimate.status != EstimateStatus::ok || !has_metric_displacement(estimate) ||
      !estimate.displacement_in_reference.allFinite() ||
      !estimate.reference_from_camera.coeffs().allFinite()) {
    return false;
  }
  reference_from_setpoint_ =
      RigidTransform{estimate.reference_from_camera, estimate.displacement_in_reference};
  return true;
}

MotionEstimate HoldSetpoint::relative(const MotionEstimate& estimate) const {
  if (!reference_from_setpoint_) return estimate;
  const RigidTransform setpoint_from_reference = reference_from_setpoint_->inverse();
  const RigidTransform setpoint_from_camera =
      setpoint_from_reference *
      RigidTransform{estimate.reference_from_camera, estimate.displacement_in_reference};
  const Eigen::Matrix3d R = setpoint_from_reference.rotation.toRotationMatrix();
  MotionEstimate out = estimate;
  out.reference_from_camera = setpoint_from_camera.rotation;
  out.rotation_covariance = R * estimate.rotation_covariance * R.transpose();
  if (!has_metric_displacement(estimate)) {
    out.displacement_kind = DisplacementKind::unknown;
    out.displacement_in_reference.setZero();
    out.displacement_covariance.setZero();
    return out;
  }
  out.displacement_kind = DisplacementKind::metric;
  out.displacement_in_reference = setpoint_from_camera.translation;
  out.displacement_covariance = R * estimate.displacement_covariance * R.transpose();
  return out;
}

}  // namespace stillkite
