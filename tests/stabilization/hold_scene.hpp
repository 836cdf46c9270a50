#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/rigid_transform.hpp"
#include "stabilization/hold_decision.hpp"

namespace stillkite {

/// Attitude of a level camera that points along x: its x is right, its y down, its z forward.
[[nodiscard]] inline Eigen::Quaterniond forward_camera() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return Eigen::Quaterniond(R);
}

/// Exact motion estimate between two poses.
[[nodiscard]] inline MotionEstimate exact_estimate(const RigidTransform& station_from_reference,
                                                   const RigidTransform& station_from_camera) {
  const RigidTransform reference_from_camera =
      station_from_reference.inverse() * station_from_camera;
  MotionEstimate estimate;
  estimate.status = EstimateStatus::ok;
  estimate.reference_from_camera = reference_from_camera.rotation;
  estimate.displacement_kind = DisplacementKind::metric;
  estimate.displacement_in_reference = reference_from_camera.translation;
  estimate.mean_shift_px = 100;
  return estimate;
}

}  // namespace stillkite
