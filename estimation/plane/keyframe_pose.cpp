#include "estimation/plane/keyframe_pose.hpp"

#include <Eigen/Cholesky>

#include "geometry/plane.hpp"

namespace stillkite {

PlaneMotion motion_between(const RigidTransform& world_from_keyframe,
                           const RigidTransform& world_from_camera) {
  const RigidTransform camera_from_keyframe = world_from_camera.inverse() * world_from_keyframe;
  const GroundPlane ground = ground_plane_in_camera(world_from_keyframe);
  return {.rotation = camera_from_keyframe.rotation,
          .translation = camera_from_keyframe.translation / ground.height_m,
          .normal = ground.normal_in_camera};
}

TiltPrior tilt_prior(const PoseEstimate& keyframe, const LevellingConfig& config) {
  // world x and y in camera: a rotation of the normal by +a is an attitude error of -a
  TiltPrior prior;
  prior.axes = keyframe.world_from_camera.rotation.conjugate().toRotationMatrix().leftCols<2>();
  if (config.enabled) {
    const double slope = config.ground_slope_sigma_rad;
    prior.covariance = keyframe.covariance.block<2, 2>(3, 3) +
                       std::max(slope * slope, 1e-12) * Eigen::Matrix2d::Identity();
  }
  return prior;
}

ChainedPose chain(const PoseEstimate& keyframe, const PlaneAlignment& alignment,
                  const LevellingConfig& config) {
  using Matrix62 = Eigen::Matrix<double, 6, 2>;
  const Matrix6d total = alignment.covariance.topLeftCorner<6, 6>() + alignment.smooth_covariance;
  const Matrix6d independent = alignment.plane_likelihood.covariance - alignment.smooth_covariance;
  const Eigen::Matrix2d tilt = alignment.covariance.bottomRightCorner<2, 2>();
  const Eigen::Matrix<double, 2, 6> tilt_motion_cross =
      alignment.covariance.bottomLeftCorner<2, 6>();

  // 1. correct the keyframe pose by the estimated tilt (Kalman gain K = cross S^-1)
  ChainedPose out;
  out.keyframe = keyframe;
  Matrix62 K = Matrix62::Zero();
  if (const TiltPrior prior = tilt_prior(keyframe, config); prior.covariance) {
    const Matrix62 cross = -keyframe.covariance.middleCols<2>(3);
    const Eigen::LDLT<Eigen::Matrix2d> S(*prior.covariance);
    K = S.solve(cross.transpose()).transpose();
    const Vector6d error = K * alignment.tilt_rad;
    out.keyframe.world_from_camera.translation += error.head<3>();
    out.keyframe.world_from_camera.rotation =
        (so3_exp(error.tail<3>()) * keyframe.world_from_camera.rotation).normalized();
    out.keyframe.covariance -= K * (*prior.covariance - tilt) * K.transpose();
  }

  // 2. camera pose relative to the corrected keyframe, whose height is the scale
  const double height_m = out.keyframe.world_from_camera.translation.z();
  const RigidTransform camera_from_keyframe{alignment.motion.rotation,
                                            height_m * alignment.motion.translation};
  out.keyframe_from_camera = camera_from_keyframe.inverse();
  out.camera.world_from_camera = out.keyframe.world_from_camera * out.keyframe_from_camera;

  // 3. first-order error propagation: keyframe (height is the scale), then alignment
  const Eigen::Matrix3d R = out.camera.world_from_camera.rotation.toRotationMatrix();
  const Eigen::Vector3d d =
      out.camera.world_from_camera.translation - out.keyframe.world_from_camera.translation;
  Matrix6d by_keyframe = Matrix6d::Identity();
  by_keyframe.block<3, 3>(0, 3) = -skew(d);
  by_keyframe.block<3, 1>(0, 2) += d / height_m;
  Matrix6d by_alignment = Matrix6d::Zero();
  by_alignment.topLeftCorner<3, 3>() = -height_m * R;
  by_alignment.bottomRightCorner<3, 3>() = -R;

  out.camera_by_twist = by_alignment * alignment.motion_by_twist;
  out.camera_by_twist.leftCols<3>() /= height_m;
  out.relative_covariance = by_alignment * independent * by_alignment.transpose();
  out.common_covariance = by_alignment * (total - independent) * by_alignment.transpose();
  const Matrix6d cross_term = by_keyframe * (K * tilt_motion_cross) * by_alignment.transpose();
  const Matrix6d sum = by_keyframe * out.keyframe.covariance * by_keyframe.transpose() +
                       out.relative_covariance + out.common_covariance + cross_term +
                       cross_term.transpose();
  out.camera.covariance = 0.5 * (sum + sum.transpose());
  return out;
}

}  // namespace stillkite
