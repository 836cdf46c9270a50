#include "estimation/fusion/known_landmark.hpp"

#include "estimation/fusion/landmark_model.hpp"

namespace stillkite {

std::optional<KnownLandmarkView> known_landmark_view(const RigidTransform& world_from_camera,
                                                     const Eigen::Vector3d& landmark_in_world_m,
                                                     const Eigen::Vector2d& bearing) {
  constexpr double kMinDepth_m = 0.05;
  const Eigen::Matrix3d R_t = world_from_camera.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d to_landmark_m = landmark_in_world_m - world_from_camera.translation;
  const Eigen::Vector3d Y = R_t * to_landmark_m;
  if (!(Y.z() > kMinDepth_m)) return std::nullopt;
  const Eigen::Matrix<double, 2, 3> J = bearing_by_direction(R_t, Y);
  KnownLandmarkView view{.residual = bearing - Y.hnormalized(), .by_pose = {}, .by_landmark = J};
  view.by_pose << J * skew(to_landmark_m), -J;
  return view;
}

}  // namespace stillkite
