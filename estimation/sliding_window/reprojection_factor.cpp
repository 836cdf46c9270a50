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

PairJacobians pair_jacobians(const CameraPair& pair) {
  const Eigen::Matrix3d& C = pair.camera_from_imu;
  const Eigen::Matrix3d& C_host = pair.camera_from_host_imu;
  const Eigen::Matrix3d& R = pair.camera_from_host;
  const Eigen::Matrix3d arm = skew(pair.lever_arm_m);
  const Eigen::Matrix3d baseline = skew(pair.baseline_m);
  const Eigen::Matrix3d O = Eigen::Matrix3d::Zero();
  PairJacobians out;
  out.by_host << C_host, O, baseline * C_host - C_host * arm, pair.camera_from_world;
  out.by_target << -C, O, C * arm, -pair.camera_from_world;
  out.by_extrinsics << R - Eigen::Matrix3d::Identity(), O, baseline * R, C_host - C;
  return out;
}

std::optional<PointProjection> project_point(const CameraPair& pair,
                                             const InverseDepthPoint& point) {
  const Eigen::Vector3d y = scaled_point(pair, point);
  if (!(y.z() > kMinDepthRatio)) return std::nullopt;
  PointProjection out;
  out.bearing = y.head<2>() / y.z();
  const double u = out.bearing.x();
  const double v = out.bearing.y();
  Eigen::Matrix<double, 2, 3> by_y;
  by_y << 1, 0, -u, 0, 1, -v;
  by_y /= y.z();
  out.by_pair.leftCols<3>() << -u * v, 1 + u * u, -v, -1 - v * v, u * v, u;
  out.by_pair.rightCols<3>() = point.inverse_depth * by_y;
  out.by_point << by_y * pair.camera_from_host.leftCols<2>(), by_y * pair.baseline_m;
  return out;
}

std::optional<Eigen::Vector2d> project_bearing(const CameraPair& pair,
                                               const InverseDepthPoint& point) {
  const Eigen::Vector3d y = scaled_point(pair, point);
  if (!(y.z() > kMinDepthRatio)) return std::nullopt;
  return y.head<2>() / y.z();
}

}  // namespace stillkite
