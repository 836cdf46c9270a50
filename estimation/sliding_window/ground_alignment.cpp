#include "estimation/sliding_window/ground_alignment.hpp"

#include <Eigen/Cholesky>

namespace stillkite {
namespace {

// Unit normal towards the ground, and distance.
struct UnitNormal {
  Eigen::Vector3d normal;
  double distance_m;
};

UnitNormal unit_normal(const GroundView& ground) {
  const double norm = ground.normal.norm();
  return {-ground.normal / norm, ground.height_m / norm};
}

// Both parts of a motion in axes of the keyframe.
template <int kColumns>
Eigen::Matrix<double, 6, kColumns> in_keyframe(const Eigen::Quaterniond& current_from_keyframe,
                                               const Eigen::Matrix<double, 6, kColumns>& motion) {
  const Eigen::Matrix3d R = current_from_keyframe.conjugate().toRotationMatrix();
  Eigen::Matrix<double, 6, kColumns> out;
  out << R * motion.template topRows<3>(), R * motion.template bottomRows<3>();
  return out;
}

}  // namespace

GroundAlignment ground_alignment(const KeyframeView& view, std::int64_t keyframe_id,
                                 std::int64_t frame_id) {
  const Eigen::Quaterniond& rotation = view.motion.rotation;
  const Matrix6d half = in_keyframe<6>(rotation, view.measured.covariance);
  const Matrix6d covariance = in_keyframe<6>(rotation, half.transpose());
  return {.keyframe_id = keyframe_id,
          .frame_id = frame_id,
          .motion = view.motion,
          .tilt_axes = view.tilt_axes,
          .information = covariance.ldlt().solve(Matrix6d::Identity()),
          .motion_by_tilt = in_keyframe<2>(rotation, view.measured.motion_by_tilt),
          .tilt_information = view.measured.tilt_information,
          .tilt_information_rad = view.measured.tilt_information_rad};
}

GroundAlignmentResidual ground_alignment_residual(const GroundAlignment& alignment,
                                                  const CameraPair& pair,
                                                  const GroundView& ground) {
  const PlaneMotion& aligned = alignment.motion;
  const auto [normal, distance_m] = unit_normal(ground);
  const Eigen::Vector3d t = pair.baseline_m / distance_m;
  const Eigen::Quaterniond turn =
      aligned.rotation * Eigen::Quaterniond(pair.camera_from_host).conjugate();
  Vector6d motion;
  motion << aligned.translation - turn * t, so3_log(turn);
  GroundAlignmentResidual out;
  out.tilt_rad = alignment.tilt_axes.transpose() * aligned.normal.cross(normal);
  out.motion = in_keyframe<1>(aligned.rotation, motion) + alignment.motion_by_tilt * out.tilt_rad;
  Vector6d by_log_height;
  by_log_height << aligned.translation, Eigen::Vector3d::Zero();
  out.by_log_height = in_keyframe<1>(aligned.rotation, by_log_height);
  return out;
}

// Predicted motion: dt = (db - t dh) / h, rotation r. Normal: dn = -(I - n n^T) dN / |N|, h = H /
// |N|. With t as aligned h t - b is linear: the linearization point does not measure the scale.
GroundAlignmentJacobians ground_alignment_jacobians(const GroundAlignment& alignment,
                                                    const GroundView& ground) {
  const auto [normal, distance_m] = unit_normal(ground);
  const Eigen::Vector3d& t = alignment.motion.translation;
  const double norm = ground.normal.norm();
  GroundAlignmentJacobians out;
  out.tilt_by_ground.leftCols<3>() =
      -alignment.tilt_axes.transpose() * skew(alignment.motion.normal) *
      (Eigen::Matrix3d::Identity() - normal * normal.transpose()) / norm;
  out.tilt_by_ground.col(3).setZero();
  Matrix6d by_pair = Matrix6d::Zero();
  by_pair.topRightCorner<3, 3>() = Eigen::Matrix3d::Identity() / distance_m;
  by_pair.bottomLeftCorner<3, 3>().setIdentity();
  Eigen::Matrix<double, 6, 4> by_ground = Eigen::Matrix<double, 6, 4>::Zero();
  by_ground.topLeftCorner<3, 3>() = -t * normal.transpose() / norm;
  by_ground.topRightCorner<3, 1>() = -t / ground.height_m;
  const Eigen::Quaterniond& rotation = alignment.motion.rotation;
  out.motion_by_pair = in_keyframe<6>(rotation, by_pair);
  out.motion_by_ground =
      in_keyframe<4>(rotation, by_ground) - alignment.motion_by_tilt * out.tilt_by_ground;
  return out;
}

}  // namespace stillkite
