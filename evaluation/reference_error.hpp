#pragma once

#include <optional>
#include <span>

#include "evaluation/association.hpp"
#include "evaluation/consistency.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Errors of poses seen from their reference frames, over the frames whose report's status is ok,
/// whatever the frame's own verdict.
struct ReferenceError {
  int rotations = 0;
  double rotation_median_deg = 0;
  int directions = 0;  ///< frames that told one and that had truly moved
  std::optional<double> direction_median_deg;
  std::optional<double> displacement_rmse_m;  ///< of metric displacements
  std::optional<Consistency> rotation_nees, direction_nees;
};

/// Nothing where no frame has a pose from a reference, or none of them a truth.
[[nodiscard]] std::optional<ReferenceError> reference_error(
    std::span<const NavigationEstimate> estimates, std::span<const StampedPose> truth,
    const RigidTransform& body_from_camera, double tolerance_s);

}  // namespace stillkite
