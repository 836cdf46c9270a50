#include "app/level_displacement.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/chi_square.hpp"

namespace stillkite {
namespace {

// Heading of the body's forward axis, from world x to y.
double heading_rad(const Eigen::Quaterniond& world_from_body) {
  const Eigen::Vector3d forward = world_from_body * Eigen::Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

}  // namespace

LevelDisplacement level_displacement(const MotionEstimate& motion,
                                     const Eigen::Quaterniond& world_from_body,
                                     const RigidTransform& body_from_camera) {
  // camera at the pose to hold
  const Eigen::Quaterniond world_from_reference =
      world_from_body * body_from_camera.rotation * motion.reference_from_camera.conjugate();
  const double reference_heading_rad =
      heading_rad(world_from_reference * body_from_camera.rotation.conjugate());
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(-reference_heading_rad, Eigen::Vector3d::UnitZ()) * world_from_reference)
          .toRotationMatrix();
  return {.displacement = R * motion.displacement_in_reference,
          .covariance = R * motion.displacement_covariance * R.transpose(),
          .yaw_rad = std::remainder(heading_rad(world_from_body) - reference_heading_rad,
                                    2 * std::numbers::pi)};
}

DisplacementEllipse horizontal_ellipse(const Eigen::Matrix3d& covariance) {
  constexpr double kProbability = 0.95;
  static const double scale = std::sqrt(chi_square_quantile(kProbability, 2));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(covariance.topLeftCorner<2, 2>());
  const Eigen::Vector2d sigmas = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  const Eigen::Vector2d axis = solver.eigenvectors().col(1);
  return {.major = scale * sigmas.y(),
          .minor = scale * sigmas.x(),
          .angle_rad = std::atan2(axis.y(), axis.x())};
}

}  // namespace stillkite
