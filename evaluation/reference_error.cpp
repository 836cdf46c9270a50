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

struct ReferenceSamples {
  std::vector<double> rotation_deg, direction_deg, displacement_squared_m2;
  std::vector<double> rotation_nees, direction_nees;
};

std::optional<double> median_of(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  return median(std::move(values));
}

void add_direction(const MotionEstimate& motion, const Eigen::Vector3d& true_displacement_m,
                   ReferenceSamples& samples) {
  const Eigen::Vector3d found = motion.displacement_in_reference.normalized();
  const Eigen::Vector3d truth = true_displacement_m.normalized();
  samples.direction_deg.push_back(angle_between_rad(found, truth) / kDegree);
  if (motion.displacement_kind != DisplacementKind::direction) return;
  // error orthogonal to the unit vector; any variance along it
  const Eigen::Vector3d error = found - truth * found.dot(truth);
  const auto value = nees(error, motion.displacement_covariance + truth * truth.transpose());
  if (value) samples.direction_nees.push_back(*value);
}

void add_pose(const MotionEstimate& motion, const RigidTransform& true_reference_from_camera,
              ReferenceSamples& samples) {
  const Eigen::Vector3d rotation_error =
      so3_log(motion.reference_from_camera * true_reference_from_camera.rotation.conjugate());
  samples.rotation_deg.push_back(rotation_error.norm() / kDegree);
  if (const auto value = nees(rotation_error, motion.rotation_covariance)) {
    samples.rotation_nees.push_back(*value);
  }
  const Eigen::Vector3d& displacement_m = true_reference_from_camera.translation;
  const bool is_metric = motion.displacement_kind == DisplacementKind::metric;
  if (is_metric) {
    samples.displacement_squared_m2.push_back(
        (motion.displacement_in_reference - displacement_m).squaredNorm());
  }
  const bool has_direction = is_metric || motion.displacement_kind == DisplacementKind::direction;
  if (has_direction && displacement_m.norm() > kMinDisplacement_m) {
    add_direction(motion, displacement_m, samples);
  }
}

}  // namespace

std::optional<ReferenceError> reference_error(std::span<const NavigationEstimate> estimates,
                                              std::span<const StampedPose> truth,
                                              const RigidTransform& body_from_camera,
                                              double tolerance_s) {
  ReferenceSamples samples;
  for (const NavigationEstimate& estimate : estimates) {
    // excludes a new reference relative to itself
    if (!estimate.reference || estimate.reference->motion.status != EstimateStatus::ok ||
        estimate.reference->reference_stamp == estimate.stamp) {
      continue;
    }
    const auto reference = pose_at(truth, estimate.reference->reference_stamp, tolerance_s);
    const auto camera = pose_at(truth, estimate.stamp, tolerance_s);
    if (!reference || !camera) continue;
    const RigidTransform reference_from_camera =
        (*reference * body_from_camera).inverse() * (*camera * body_from_camera);
    add_pose(estimate.reference->motion, reference_from_camera, samples);
  }
  const std::optional<double> rotation_deg = median_of(samples.rotation_deg);
  if (!rotation_deg) return std::nullopt;
  ReferenceError error{.rotations = static_cast<int>(samples.rotation_deg.size()),
                       .rotation_median_deg = *rotation_deg,
                       .directions = static_cast<int>(samples.direction_deg.size()),
                       .direction_median_deg = median_of(samples.direction_deg),
                       .rotation_nees = consistency(samples.rotation_nees, 3),
                       .direction_nees = consistency(samples.direction_nees, 2)};
  const std::vector<double>& squared = samples.displacement_squared_m2;
  if (!squared.empty()) {
    double sum = 0;
    for (const double value : squared) sum += value;
    error.displacement_rmse_m = std::sqrt(sum / static_cast<double>(squared.size()));
  }
  return error;
}

}  // namespace stillkite
