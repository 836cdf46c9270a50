#include "estimation/sliding_window/reprojection_factor.hpp"

#include "estimation/sliding_window/inertial_state.hpp"

namespace stillkite {
namespace {

constexpr double kMinDepthRatio = 0.01;  // to the depth in the first keyframe

// Point in the other camera, over its depth in the first keyframe.
Eigen::Vector3d scaled_point(const CameraPair& pair, const InverseDepthPoint& point) {
  return pair.camera_from_host * point.bearing.homogeneous() +
         point.inverse_depth * pair.baseline_m;
}

}  // namespace

CameraExtrinsics plus(const CameraExtrinsics& extrinsics, const ExtrinsicsError& error) {
  CameraExtrinsics out = extrinsics;
  RigidTransform& imu_from_camera = out.imu_from_camera;
  imu_from_camera.rotation =
      (imu_from_camera.rotation * so3_exp(error.segment<3>(ExtrinsicsIndex::kRotation)))
          .normalized();
  imu_from_camera.translation += error.segment<3>(ExtrinsicsIndex::kLeverArm);
  out.time_offset_s += error[ExtrinsicsIndex::kTimeOffset];
  return out;
}

ExtrinsicsError minus(const CameraExtrinsics& to, const CameraExtrinsics& from) {
  ExtrinsicsError error;
  error << so3_log(from.imu_from_camera.rotation.conjugate() * to.imu_from_camera.rotation),
      to.imu_from_camera.translation - from.imu_from_camera.translation,
      to.time_offset_s - from.time_offset_s;
  return error;
}

CameraPair camera_pair(const RigidTransform& world_from_host,
                       const RigidTransform& world_from_target,
                       const RigidTransform& imu_from_camera) {
  CameraPair pair;
  pair.camera_from_imu = imu_from_camera.rotation.conjugate().toRotationMatrix();
  pair.camera_from_world =
      pair.camera_from_imu * world_from_target.rotation.conjugate().toRotationMatrix();
  pair.camera_from_host_imu = pair.camera_from_world * world_from_host.rotation.toRotationMatrix();
  pair.camera_from_host = pair.camera_from_host_imu * pair.camera_from_imu.transpose();
  pair.lever_arm_m = imu_from_camera.translation;
  pair.baseline_m =
      (pair.camera_from_host_imu - pair.camera_from_imu) * pair.lever_arm_m +
      pair.camera_from_world * (world_from_host.translation - world_from_target.translation);
  return pair;
}

std::optional<PointProjection> project_point(const CameraPair& pair,
                                             const InverseDepthPoint& point) {
  const Eigen::Vector3d y = scaled_point(pair, point);
  if (!(y.z() > kMinDepthRatio)) return std::nullopt;
  PointProjection out;
  out.bearing = y.head<2>() / y.z();
  Eigen::Matrix<double, 2, 3> by_y;
  by_y << 1, 0, -out.bearing.x(), 0, 1, -out.bearing.y();
  by_y /= y.z();

  const double rho = point.inverse_depth;
  const Eigen::Vector3d x = point.bearing.homogeneous();
  const Eigen::Vector3d in_host_imu = pair.camera_from_imu.transpose() * x + rho * pair.lever_arm_m;
  const Eigen::Vector3d in_target_imu =
      pair.camera_from_imu.transpose() * y + rho * pair.lever_arm_m;
  const Eigen::Matrix<double, 2, 3> by_host_imu = by_y * pair.camera_from_host_imu;
  const Eigen::Matrix<double, 2, 3> by_host_camera = by_y * pair.camera_from_host;
  const Eigen::Matrix<double, 2, 3> by_target_imu = by_y * pair.camera_from_imu;
  const Eigen::Matrix<double, 2, 3> by_position = rho * by_y * pair.camera_from_world;
  out.by_host << -by_host_imu * skew(in_host_imu), by_position;
  out.by_target << by_target_imu * skew(in_target_imu), -by_position;
  out.by_extrinsics << by_y * skew(y) - by_host_camera * skew(x),
      rho * (by_host_imu - by_target_imu);
  out.by_point << by_host_camera.leftCols<2>(), by_y * pair.baseline_m;
  return out;
}

std::optional<Eigen::Vector2d> project_bearing(const CameraPair& pair,
                                               const InverseDepthPoint& point) {
  const Eigen::Vector3d y = scaled_point(pair, point);
  if (!(y.z() > kMinDepthRatio)) return std::nullopt;
  return y.head<2>() / y.z();
}

}  // namespace stillkite
