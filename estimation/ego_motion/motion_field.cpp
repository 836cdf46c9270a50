#include "estimation/ego_motion/motion_field.hpp"

#include <algorithm>

namespace stillkite {

MotionFieldMatrix motion_field(const GroundPlane& ground, const Eigen::Vector2d& bearing) {
  return motion_field(bearing, std::max(0.0, inverse_depth(ground, bearing)));
}

MotionFieldMatrix motion_field_px(const Camera& camera, const GroundPlane& ground,
                                  const Eigen::Vector2d& bearing) {
  return distort(camera, bearing).jacobian * motion_field(ground, bearing);
}

PaperMotionField paper_motion_field(const RigidTransform& world_from_camera,
                                    const Eigen::Vector2d& bearing) {
  const MotionFieldMatrix m = motion_field(ground_plane_in_camera(world_from_camera), bearing);
  // chain rule with v = R^T V
  const Eigen::Matrix<double, 2, 3> by_world_velocity =
      m.leftCols<3>() * world_from_camera.rotation.conjugate().toRotationMatrix();
  return {by_world_velocity.leftCols<2>(), m.rightCols<3>(), by_world_velocity.col(2)};
}

}  // namespace stillkite
