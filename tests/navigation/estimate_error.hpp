#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>

#include "estimation/motion_estimate.hpp"
#include "geometry/angle.hpp"
#include "tests/navigation/prescribed_flight.hpp"

// Motions of the contract test, and error measures of an estimate.

namespace stillkite::test {

inline constexpr double kTranslation_m = 0.4;
inline constexpr double kRotation_rad = 10 * kDegree;
inline constexpr int kLastFrame = PrescribedFlight::kFrames - 1;

// Rotations come with a translation across their axis: in the rotated camera's axes, or with an
// inverted rotation, the direction error is 10 degrees or more.
inline const PrescribedMotion kMotions[] = {
    {.name = "right", .translation_in_reference_m = {kTranslation_m, 0, 0}},
    {.name = "down", .translation_in_reference_m = {0, kTranslation_m, 0}},
    {.name = "ahead", .translation_in_reference_m = {0, 0, kTranslation_m}},
    {.name = "pitch",
     .translation_in_reference_m = {0, kTranslation_m, 0},
     .rotation_in_reference_rad = {kRotation_rad, 0, 0}},
    {.name = "yaw",
     .translation_in_reference_m = {0, 0, kTranslation_m},
     .rotation_in_reference_rad = {0, kRotation_rad, 0}},
    {.name = "roll",
     .translation_in_reference_m = {-kTranslation_m, 0, 0},
     .rotation_in_reference_rad = {0, 0, kRotation_rad}}};

// Tolerances. Since the reference: half a pixel, over the focal length for rotation, over the image
// shift (0.4 m at 3.7 m: 26 px) for direction and length. Between frames: 0.2 px at 30 frames/s.
struct Tolerance {
  double rotation_rad = 0.5 / 240;
  double direction_rad = 0.5 / 26;
  double length_ratio = 0.5 / 26;
  double rate_rad_s = 0.2 / 240 * PrescribedFlight::kFramesPerSecond;
  double velocity_m_s = 0.2 / 240 * PrescribedFlight::kFramesPerSecond * 3.7;
};
inline constexpr Tolerance kTolerance;

[[nodiscard]] inline Eigen::Vector3d rotation_error(const MotionEstimate& answer,
                                                    const RigidTransform& truth) {
  return so3_log(answer.reference_from_camera * truth.rotation.conjugate());
}

[[nodiscard]] inline double direction_error_rad(const MotionEstimate& answer,
                                                const RigidTransform& truth) {
  return angle_between_rad(answer.displacement_in_reference, truth.translation);
}

// NEES e^T P^-1 e in the subspace spanned by the columns of `along`.
[[nodiscard]] inline double nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance,
                                 const Eigen::Matrix3Xd& along = Eigen::Matrix3d::Identity()) {
  const Eigen::VectorXd e = along.transpose() * error;
  const Eigen::MatrixXd P = along.transpose() * covariance * along;
  return e.dot(P.ldlt().solve(e));
}

// Subspace in which a direction is observable: perpendicular to it.
[[nodiscard]] inline Eigen::Matrix3Xd across(const Eigen::Vector3d& direction) {
  Eigen::Matrix3Xd axes(3, 2);
  axes.col(0) = direction.unitOrthogonal();
  axes.col(1) = direction.normalized().cross(axes.col(0));
  return axes;
}

[[nodiscard]] inline double displacement_nees(const MotionEstimate& answer,
                                              const RigidTransform& truth) {
  const Eigen::Vector3d& displacement_m = truth.translation;
  if (answer.displacement_kind == DisplacementKind::metric) {
    return nees(answer.displacement_in_reference - displacement_m, answer.displacement_covariance);
  }
  return nees(answer.displacement_in_reference - displacement_m.normalized(),
              answer.displacement_covariance, across(displacement_m));
}

// Error relative to the displacement's length; for a direction its angle.
[[nodiscard]] inline double displacement_error_ratio(const MotionEstimate& answer,
                                                     const RigidTransform& truth) {
  const Eigen::Vector3d& displacement_m = truth.translation;
  return answer.displacement_kind == DisplacementKind::metric
             ? (answer.displacement_in_reference - displacement_m).norm() / displacement_m.norm()
             : direction_error_rad(answer, truth);
}

}  // namespace stillkite::test
