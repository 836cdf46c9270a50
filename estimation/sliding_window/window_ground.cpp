#include "estimation/sliding_window/window_ground.hpp"

namespace stillkite {
namespace {

Eigen::Vector3d upward(const WindowGround& plane) {
  return {-plane.slope.x(), -plane.slope.y(), 1};
}

}  // namespace

WindowGround plus(const WindowGround& plane, const GroundError& error) {
  return {plane.slope + error.segment<2>(GroundIndex::kSlope),
          plane.height_m + error[GroundIndex::kHeight]};
}

GroundError minus(const WindowGround& to, const WindowGround& from) {
  GroundError error;
  error << to.slope - from.slope, to.height_m - from.height_m;
  return error;
}

GroundView ground_view(const WindowGround& plane, const RigidTransform& world_from_imu,
                       const RigidTransform& imu_from_camera) {
  const RigidTransform world_from_camera = world_from_imu * imu_from_camera;
  const Eigen::Vector3d n = upward(plane);
  return {world_from_camera.rotation.conjugate() * n,
          n.dot(world_from_camera.translation) - plane.height_m};
}

GroundViewJacobians ground_view_jacobians(const WindowGround& plane,
                                          const RigidTransform& world_from_imu,
                                          const RigidTransform& imu_from_camera) {
  const Eigen::Vector3d n = upward(plane);
  const Eigen::Vector3d in_imu = world_from_imu.rotation.conjugate() * n;
  const Eigen::Matrix3d camera_from_imu = imu_from_camera.rotation.conjugate().toRotationMatrix();
  const RigidTransform world_from_camera = world_from_imu * imu_from_camera;
  GroundViewJacobians out;
  out.by_pose << camera_from_imu * skew(in_imu), Eigen::Matrix3d::Zero(),
      imu_from_camera.translation.cross(in_imu).transpose(), n.transpose();
  out.by_extrinsics << skew(camera_from_imu * in_imu), Eigen::Matrix3d::Zero(),
      Eigen::RowVector3d::Zero(), in_imu.transpose();
  out.by_plane.setZero();
  out.by_plane.topLeftCorner<3, 2>() =
      -world_from_camera.rotation.conjugate().toRotationMatrix().leftCols<2>();
  out.by_plane.bottomLeftCorner<1, 2>() = -world_from_camera.translation.head<2>().transpose();
  out.by_plane(3, GroundIndex::kHeight) = -1;
  return out;
}

std::optional<InverseDepthPoint> point_on_ground(const GroundView& view,
                                                 const Eigen::Vector2d& bearing) {
  constexpr double kMinDescent = 0.1;  // six degrees below the horizon
  const Eigen::Vector3d ray = bearing.homogeneous();
  const double rise = view.normal.dot(ray);
  if (!(rise < -kMinDescent * ray.norm()) || !(view.height_m > 0)) return std::nullopt;
  return InverseDepthPoint{bearing, -rise / view.height_m};
}

}  // namespace stillkite
