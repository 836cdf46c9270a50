#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "estimation/landmark_view.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Where landmarks put the camera, were they where they are said to be.
struct Resection {
  RigidTransform world_from_camera;  ///< map units
  Matrix6d information;              ///< of (rotation, position), world axes
};

/// By least squares from the state's pose. Nothing where too few of the landmarks are seen.
[[nodiscard]] std::optional<Resection> resection(FusionState state,
                                                 const std::vector<Landmark>& landmarks,
                                                 std::span<const FeatureView> seen);

}  // namespace stillkite
