#pragma once

#include <optional>
#include <span>

#include "evaluation/association.hpp"
#include "evaluation/consistency.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Errors of poses relative to their reference frames, over frames with reference status ok,
/// independent of the frame's verdict.
struct ReferenceError {
  int rotations = 0;
  double rotation_median_deg = 0;
  int directions = 0;  ///< frames with an estimated direction and a true displacement
  std::optional<double> direction_median_deg;
  std::optional<double> displacement_rmse_m;  ///< of metric displacements only
  std::optional<Consistency> rotation_nees, direction_nees;
};

/// std::nullopt if no frame has both a pose from a reference and a truth.
[[nodiscard]] std::optional<ReferenceError> reference_error(
    std::span<const NavigationEstimate> estimates, std::span<const StampedPose> truth,
    const RigidTransform& body_from_camera, double tolerance_s);

}  // namespace stillkite
