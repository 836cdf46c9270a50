#include "evaluation/reference_error.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/angle.hpp"
#include "geometry/median.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

// Minimum true displacement with a defined direction.
constexpr double kMinDisplacement_m = 1e-3;

std::optional<double> median_of(std::vector<double> values) {
  if (values.size() < 2) return std::nullopt;
  return median(std::move(values));
}

}  // namespace

void ReferenceErrors::add_direction(const MotionEstimate& motion,
                                    const Eigen::Vector3d& true_displacement_m) {
  const Eigen::Vector3d found = motion.displacement_in_reference.normalized();
  const Eigen::Vector3d truth = true_displacement_m.normalized();
  direction_deg_.push_back(angle_between_rad(found, truth) / kDegree);
  if (motion.displacement_kind != DisplacementKind::direction) return;
  // error orthogonal to the unit vector; any variance along it
  const Eigen::Vector3d error = found - truth * found.dot(truth);
  const auto value = nees(error, motion.displacement_covariance + truth * truth.transpose());
  if (value) direction_nees_.push_back(*value);
}

void ReferenceErrors::add_pose(const MotionEstimate& motion,
                               const RigidTransform& true_reference_from_camera) {
  const Eigen::Vector3d rotation_error =
      so3_log(motion.reference_from_camera * true_reference_from_camera.rotation.conjugate());
  rotation_deg_.push_back(rotation_error.norm() / kDegree);
  if (const auto value = nees(rotation_error, motion.rotation_covariance)) {
    rotation_nees_.push_back(*value);
  }
  const Eigen::Vector3d& displacement_m = true_reference_from_camera.translation;
  const bool is_metric = motion.displacement_kind == DisplacementKind::metric;
  if (is_metric) {
    displacement_squared_m2_.push_back(
        (motion.displacement_in_reference - displacement_m).squaredNorm());
  }
  const bool has_direction = is_metric || motion.displacement_kind == DisplacementKind::direction;
  if (has_direction && displacement_m.norm() > kMinDisplacement_m) {
    add_direction(motion, displacement_m);
  }
}

void ReferenceErrors::add(const NavigationEstimate& estimate, std::span<const StampedPose> truth,
                          const RigidTransform& body_from_camera, double tolerance_s) {
  // excludes a new reference relative to itself
  if (!estimate.reference || estimate.reference->motion.status != EstimateStatus::ok ||
      estimate.reference->reference_stamp == estimate.stamp) {
    return;
  }
  const auto reference = pose_at(truth, estimate.reference->reference_stamp, tolerance_s);
  const auto camera = pose_at(truth, estimate.stamp, tolerance_s);
  if (!reference || !camera) return;
  add_pose(estimate.reference->motion,
           (*reference * body_from_camera).inverse() * (*camera * body_from_camera));
}

std::optional<ReferenceError> ReferenceErrors::error() const {
  const std::optional<double> rotation_deg = median_of(rotation_deg_);
  if (!rotation_deg) return std::nullopt;
  ReferenceError error{.rotations = static_cast<int>(rotation_deg_.size()),
                       .rotation_median_deg = *rotation_deg,
                       .directions = static_cast<int>(direction_deg_.size()),
                       .direction_median_deg = median_of(direction_deg_),
                       .rotation_nees = consistency(rotation_nees_, 3),
                       .direction_nees = consistency(direction_nees_, 2)};
  const std::vector<double>& squared = displacement_squared_m2_;
  if (squared.size() >= 2) {
    double sum = 0;
    for (const double value : squared) sum += value;
    error.displacement_rmse_m = std::sqrt(sum / static_cast<double>(squared.size()));
  }
  return error;
}

std::optional<ReferenceError> reference_error(std::span<const NavigationEstimate> estimates,
                                              std::span<const StampedPose> truth,
                                              const RigidTransform& body_from_camera,
                                              double tolerance_s) {
  ReferenceErrors errors;
  for (const NavigationEstimate& estimate : estimates) {
    errors.add(estimate, truth, body_from_camera, tolerance_s);
  }
  return errors.error();
}

}  // namespace stillkite
