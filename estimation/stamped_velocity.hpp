#pragma once

#include <Eigen/Core>

#include "geometry/time.hpp"

namespace stillkite {

/// Velocity at one instant.
struct StampedVelocity {
  Timestamp stamp;
  Eigen::Vector3d velocity_in_world_m_s;
};

}  // namespace stillkite
