#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace stillkite {

/// A point on the ground that a map tells, with the covariance of the map's error, which is the
/// same at every sighting.
struct KnownLandmark {
  Eigen::Vector3d position_in_world_m;
  Eigen::Matrix3d covariance_m2;
};

/// Where something is seen, on z = 1, that is taken for the map's landmark of that number.
struct LandmarkSighting {
  int landmark = 0;
  Eigen::Vector2d bearing;
  Eigen::Matrix2d covariance;  ///< white: another error in each frame
};

enum class SightingVerdict : std::uint8_t {
  used,
  awaiting,  ///< the landmark's first, or not where the one before was
  refused,   ///< beyond the gate, not what most others say, or of no landmark at hand
};

}  // namespace stillkite
