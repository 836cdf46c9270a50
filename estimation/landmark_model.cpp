#include "estimation/landmark_model.hpp"

namespace stillkite {

std::optional<Innovation<2>> landmark_innovation(const FusionState& state, const Landmark& landmark,
                                                 int column, const Eigen::Vector2d& seen,
                                                 const Eigen::Matrix2d& covariance) {
  using Index = FusionIndex;
  constexpr double kNearest = 0.05;
  const Eigen::Matrix3d R_t = state.world_from_camera.rotation.conjugate().toRotationMatrix();
  const Eigen::Matrix3d R_a = state.world_from_anchor.rotation.toRotationMatrix();
  const Eigen::Vector3d to_anchor =
      state.world_from_anchor.translation - state.world_from_camera.translation;
  const Eigen::Vector3d beside = R_a * landmark.bearing.homogeneous();
  const Eigen::Vector3d u = landmark.inverse_depth * to_anchor + beside;
  const Eigen::Vector3d Y = R_t * u;
  if (!(Y.z() > kNearest)) return std::nullopt;
  const Eigen::Vector2d h = Y.head<2>() / Y.z();

  Eigen::Matrix<double, 2, 3> J;
  J << 1, 0, -h.x(), 0, 1, -h.y();
  J = (J / Y.z() * R_t).eval();
  Eigen::Matrix3d of_landmark;
  of_landmark << R_a.leftCols<2>(), to_anchor;
  Innovation<2> innovation{.residual = seen - h, .H = {}, .noise = covariance};
  innovation.H.add(Index::kRotation, J * skew(u));
  innovation.H.add(Index::kPosition, -landmark.inverse_depth * J);
  innovation.H.add(Index::kAnchorRotation, -J * skew(beside));
  innovation.H.add(Index::kAnchorPosition, landmark.inverse_depth * J);
  innovation.H.add(column, J * of_landmark);
  return innovation;
}

}  // namespace stillkite
