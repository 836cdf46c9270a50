#include "live/mavlink/body_state.hpp"

#include <algorithm>
#include <cmath>

#include "live/mavlink/axes.hpp"

namespace stillkite::mavlink {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d out;
  out << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return out;
}

// Twist of the camera to that of the body's origin: v_b = R v_c + p x (R w_c), w_b = R w_c, with
// the camera's rotation R and position p in the body.
Matrix6d body_from_camera_twist(const RigidTransform& body_from_camera) {
  const Eigen::Matrix3d R = body_from_camera.rotation.toRotationMatrix();
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = R;
  J.topRightCorner<3, 3>() = cross_matrix(body_from_camera.translation) * R;
  J.bottomRightCorner<3, 3>() = R;
  return J;
}

std::int8_t quality_of(const NavigationEstimate& estimate) {
  const double ratio = estimate.verdict == Verdict::ok ? estimate.quality.inlier_ratio : 1;
  return static_cast<std::int8_t>(std::clamp(std::lround(100 * ratio), 1L, 100L));
}

// The distance grows without bound as the body's down axis approaches the horizon.
std::optional<double> ground_distance_m(const RigidTransform& world_from_body) {
  constexpr double kMinCosine = 0.1;
  const double cosine = (world_from_body.rotation * Eigen::Vector3d::UnitZ()).z();
  if (world_from_body.translation.z() <= 0) return std::nullopt;
  return world_from_body.translation.z() / std::max(cosine, kMinCosine);
}

bool is_finite(const NavigationEstimate& estimate) {
  return estimate.world_from_body.translation.allFinite() &&
         estimate.world_from_body.rotation.coeffs().allFinite() &&
         estimate.pose_covariance.allFinite() && estimate.twist_in_camera.vector().allFinite() &&
         estimate.twist_covariance.allFinite() && std::isfinite(estimate.quality.inlier_ratio);
}

}  // namespace

std::optional<BodyState> body_state(const NavigationEstimate& estimate,
                                    const RigidTransform& body_from_camera,
                                    std::uint8_t reset_counter) {
  const bool has_motion = estimate.verdict == Verdict::ok || estimate.verdict == Verdict::still;
  if (!has_motion || estimate.scale == ScaleSource::none || !is_finite(estimate)) {
    return std::nullopt;
  }
  const Matrix6d J = body_from_camera_twist(body_from_camera);
  const Vector6d twist = J * estimate.twist_in_camera.vector();
  return BodyState{
      .stamp = estimate.stamp,
      .position_in_local_m = flip_axes(estimate.world_from_body.translation),
      .local_from_body = flip_axes(estimate.world_from_body.rotation),
      .pose_covariance = flip_axes(estimate.pose_covariance),
      .velocity_in_body_m_s = flip_axes(Eigen::Vector3d(twist.head<3>())),
      .angular_rate_in_body_rad_s = flip_axes(Eigen::Vector3d(twist.tail<3>())),
      .twist_covariance = flip_axes(Matrix6d(J * estimate.twist_covariance * J.transpose())),
      .ground_distance_m = ground_distance_m(estimate.world_from_body),
      .quality = quality_of(estimate),
      .reset_counter = reset_counter};
}

}  // namespace stillkite::mavlink
