#pragma once

#include <Eigen/Core>

#include "io/import/imported_flight.hpp"

namespace stillkite {

/// Tangent plane of the WGS 84 ellipsoid: x east, y north, z up.
class LocalFrame {
 public:
  explicit LocalFrame(const GeodeticPosition& origin);

  /// Position in m, exact for any distance.
  [[nodiscard]] Eigen::Vector3d position_m(const GeodeticPosition& position) const;

  [[nodiscard]] const GeodeticPosition& origin() const { return origin_; }

 private:
  GeodeticPosition origin_;
  Eigen::Vector3d origin_in_earth_m_;
  Eigen::Matrix3d local_from_earth_;
};

}  // namespace stillkite
