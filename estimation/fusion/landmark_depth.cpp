#include "estimation/fusion/landmark_depth.hpp"

#include <algorithm>

namespace stillkite {

double guessed_inverse_depth(const FusionState& state, const Eigen::Vector2d& bearing,
                             double height) {
  constexpr double kSteepness = 0.3;
  const double down = -up(state).dot(state.world_from_anchor.rotation * bearing.homogeneous());
  return std::max(down, kSteepness) / std::max(height, 1e-3);
}

std::optional<double> triangulated_inverse_depth(const FusionState& state,
                                                 const Eigen::Vector2d& in_anchor,
                                                 const Eigen::Vector2d& in_camera, double guess) {
  constexpr double kParallax_rad = 0.03;
  const RigidTransform camera_from_anchor =
      state.world_from_camera.inverse() * state.world_from_anchor;
  const Eigen::Vector3d b = in_camera.homogeneous().normalized();
  const Eigen::Vector3d m = camera_from_anchor.rotation * in_anchor.homogeneous();
  const Eigen::Vector3d across = b.cross(camera_from_anchor.translation);
  if (guess * across.norm() < kParallax_rad * m.norm()) return std::nullopt;
  return -b.cross(m).dot(across) / across.squaredNorm();
}

}  // namespace stillkite
