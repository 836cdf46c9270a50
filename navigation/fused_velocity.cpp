#include "navigation/fused_velocity.hpp"

#include <Eigen/Cholesky>

#include "geometry/angle.hpp"

namespace stillkite {

VectorEstimate velocity_by_way(const FusionFilter& filter, double step_s,
                               const Eigen::Quaterniond& world_from_axes) {
  const Eigen::Matrix3d R_t = world_from_axes.conjugate().toRotationMatrix();
  if (!(step_s > 0) || filter.has_leapt()) {
    return {R_t * filter.velocity_in_world_m_s(),
            R_t * filter.velocity_covariance() * R_t.transpose()};
  }
  return {R_t * filter.step_m() / step_s,
          R_t * filter.step_covariance() * R_t.transpose() / square(step_s)};
}

// The height counts once they are one: what it is off by they share.
VectorEstimate velocity_by_way_and_ground(const FusionFilter& filter, const VectorEstimate& by_way,
                                          const NavigationEstimate& flow, double flow_height_m,
                                          double variance_ratio, double gate_sigma) {
  constexpr double kUntold = 1.7;  // its NEES is 3.8 to 5.1 of 3 where lens and ground are as told
  const double ratio = filter.height_m() / flow_height_m;
  const VectorEstimate by_ground{
      ratio * flow.twist_in_camera.velocity_m_s,
      kUntold * variance_ratio * square(ratio) * flow.twist_covariance.topLeftCorner<3, 3>()};
  const Eigen::Vector3d off = by_ground.mean - by_way.mean;
  const Eigen::LDLT<Eigen::Matrix3d> S(by_ground.covariance + by_way.covariance);
  if (!(off.dot(S.solve(off)) <= 3 * square(gate_sigma))) return by_way;
  VectorEstimate both = covariance_intersection(by_way, by_ground);
  both.covariance += filter.log_height_variance() * both.mean * both.mean.transpose();
  return both;
}

}  // namespace stillkite
