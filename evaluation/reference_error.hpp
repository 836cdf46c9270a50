#pragma once

#include <optional>
#include <span>
#include <vector>

#include "evaluation/association.hpp"
#include "evaluation/consistency.hpp"
#include "navigation/navigation_estimate.hpp"

namespace stillkite {

/// Errors of poses relative to their reference frames, over frames with reference status ok,
/// independent of the frame's verdict.
struct ReferenceError {
  int rotations = 0;
  double rotation_median_deg = 0;
  int directions = 0;  ///< frames with an estimated direction and a true displacement
  std::optional<double> direction_median_deg;
  std::optional<double> displacement_rmse_m;  ///< of metric displacements only
  std::optional<Consistency> rotation_nees, direction_nees;
};

/// Collects the errors of the frames, in any order.
class ReferenceErrors {
 public:
  void add(const NavigationEstimate& estimate, std::span<const StampedPose> truth,
           const RigidTransform& body_from_camera, double tolerance_s);
  /// std::nullopt if fewer than two frames have both a pose from a reference and a truth; a figure
  /// of fewer than two frames is empty.
  [[nodiscard]] std::optional<ReferenceError> error() const;

 private:
  void add_direction(const MotionEstimate& motion, const Eigen::Vector3d& true_displacement_m);
  void add_pose(const MotionEstimate& motion, const RigidTransform& true_reference_from_camera);

  std::vector<double> rotation_deg_, direction_deg_, displacement_squared_m2_;
  std::vector<double> rotation_nees_, direction_nees_;
};

/// Errors of a run; as ReferenceErrors.
[[nodiscard]] std::optional<ReferenceError> reference_error(
    std::span<const NavigationEstimate> estimates, std::span<const StampedPose> truth,
    const RigidTransform& body_from_camera, double tolerance_s);

}  // namespace stillkite
