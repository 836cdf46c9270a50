#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>

#include "estimation/motion_estimate.hpp"
#include "geometry/angle.hpp"
#include "tests/navigation/known_flight.hpp"

// The motions of the contract, and by how much an answer misses one of them.

namespace stillkite::test {

inline constexpr double kWay_m = 0.4;
inline constexpr double kTurn_rad = 10 * kDegree;
inline constexpr int kLast = KnownFlight::kFrames - 1;

// The turns come with a way across their axis: seen in the axes of the camera that has turned, or
// with an inverse for the rotation, it is off by 10 degrees or more.
inline const KnownMotion kMotions[] = {{.name = "right", .way_in_reference_m = {kWay_m, 0, 0}},
                                       {.name = "down", .way_in_reference_m = {0, kWay_m, 0}},
                                       {.name = "ahead", .way_in_reference_m = {0, 0, kWay_m}},
                                       {.name = "pitch",
                                        .way_in_reference_m = {0, kWay_m, 0},
                                        .turn_in_reference_rad = {kTurn_rad, 0, 0}},
                                       {.name = "yaw",
                                        .way_in_reference_m = {0, 0, kWay_m},
                                        .turn_in_reference_rad = {0, kTurn_rad, 0}},
                                       {.name = "roll",
                                        .way_in_reference_m = {-kWay_m, 0, 0},
                                        .turn_in_reference_rad = {0, 0, kTurn_rad}}};

// What may be off where all is well. All of an image: by half a pixel since the reference, of the
// focal length a turn, of the image's shift by the way (0.4 m at 3.7 m: 26 px) a direction or a
// length. From one frame to the next: by a fifth of a pixel, 30 times a second.
struct Tolerance {
  double rotation_rad = 0.5 / 240;
  double direction_rad = 0.5 / 26;
  double length_ratio = 0.5 / 26;
  double rate_rad_s = 0.2 / 240 * KnownFlight::kFramesPerSecond;
  double velocity_m_s = 0.2 / 240 * KnownFlight::kFramesPerSecond * 3.7;
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

// e^T P^-1 e; of a part of the axes where `along` has fewer columns than three.
[[nodiscard]] inline double squared_sigmas(
    const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance,
    const Eigen::Matrix3Xd& along = Eigen::Matrix3d::Identity()) {
  const Eigen::VectorXd e = along.transpose() * error;
  const Eigen::MatrixXd P = along.transpose() * covariance * along;
  return e.dot(P.ldlt().solve(e));
}

// What a direction is known in: across itself.
[[nodiscard]] inline Eigen::Matrix3Xd across(const Eigen::Vector3d& way) {
  Eigen::Matrix3Xd axes(3, 2);
  axes.col(0) = way.unitOrthogonal();
  axes.col(1) = way.normalized().cross(axes.col(0));
  return axes;
}

[[nodiscard]] inline double displacement_sigmas_squared(const MotionEstimate& answer,
                                                        const RigidTransform& truth) {
  const Eigen::Vector3d& way = truth.translation;
  if (answer.displacement_kind == DisplacementKind::metric) {
    return squared_sigmas(answer.displacement_in_reference - way, answer.displacement_covariance);
  }
  return squared_sigmas(answer.displacement_in_reference - way.normalized(),
                        answer.displacement_covariance, across(way));
}

// As a share of the way; of a direction its angle.
[[nodiscard]] inline double displacement_error_ratio(const MotionEstimate& answer,
                                                     const RigidTransform& truth) {
  const Eigen::Vector3d& way = truth.translation;
  return answer.displacement_kind == DisplacementKind::metric
             ? (answer.displacement_in_reference - way).norm() / way.norm()
             : direction_error_rad(answer, truth);
}

}  // namespace stillkite::test
