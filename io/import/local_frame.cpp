#include "io/import/local_frame.hpp"

#include <cmath>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

// Earth-centred, earth-fixed position.
Eigen::Vector3d in_earth_m(const GeodeticPosition& p) {
  constexpr double kSemiMajorAxis_m = 6'378'137, kFlattening = 1 / 298.257223563;
  constexpr double kEccentricitySquared = kFlattening * (2 - kFlattening);
  const double latitude = p.latitude_deg * kDegree, longitude = p.longitude_deg * kDegree;
  const double s = std::sin(latitude);
  const double N_m = kSemiMajorAxis_m / std::sqrt(1 - kEccentricitySquared * s * s);
  const double across_m = (N_m + p.altitude_m) * std::cos(latitude);
  return {across_m * std::cos(longitude), across_m * std::sin(longitude),
          (N_m * (1 - kEccentricitySquared) + p.altitude_m) * s};
}

}  // namespace

LocalFrame::LocalFrame(const GeodeticPosition& origin)
    : origin_(origin), origin_in_earth_m_(in_earth_m(origin)) {
  const double s = std::sin(origin.latitude_deg * kDegree);
  const double c = std::cos(origin.latitude_deg * kDegree);
  const double sl = std::sin(origin.longitude_deg * kDegree);
  const double cl = std::cos(origin.longitude_deg * kDegree);
  local_from_earth_ << -sl, cl, 0, -s * cl, -s * sl, c, c * cl, c * sl, s;
}

Eigen::Vector3d LocalFrame::position_m(const GeodeticPosition& position) const {
  return local_from_earth_ * (in_earth_m(position) - origin_in_earth_m_);
}

}  // namespace stillkite
