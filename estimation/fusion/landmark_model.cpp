#include "estimation/fusion/landmark_model.hpp"

namespace stillkite {
namespace {

constexpr double kNearest = 0.05;  // along the optical axis, of a direction

// Of a landmark from the camera, world axes, as long as the distance to it from the anchor is in
// inverse depths.
struct SightLine {
  Eigen::Vector3d to_anchor, beside, direction;
  Eigen::Vector3d in_camera;
};

SightLine sight_line(const RigidTransform& world_from_camera,
                     const RigidTransform& world_from_anchor, const Eigen::Vector2d& bearing,
                     double inverse_depth) {
  SightLine out;
  out.to_anchor = world_from_anchor.translation - world_from_camera.translation;
  out.beside = world_from_anchor.rotation * bearing.homogeneous();
  out.direction = inverse_depth * out.to_anchor + out.beside;
  out.in_camera = world_from_camera.rotation.conjugate() * out.direction;
  return out;
}

SightLine sight_line(const FusionState& state, const Landmark& landmark) {
  return sight_line(state.world_from_camera, state.world_from_anchor, landmark.bearing,
                    landmark.inverse_depth);
}

Eigen::Matrix<double, 2, 3> view_by_direction(const FusionState& state, const SightLine& line) {
  return bearing_by_direction(state.world_from_camera.rotation.conjugate().toRotationMatrix(),
                              line.in_camera);
}

}  // namespace

Eigen::Matrix<double, 2, 3> bearing_by_direction(const Eigen::Matrix3d& camera_from_world,
                                                 const Eigen::Vector3d& Y) {
  const Eigen::Vector2d h = Y.hnormalized();
  Eigen::Matrix<double, 2, 3> J;
  J << 1, 0, -h.x(), 0, 1, -h.y();
  return J / Y.z() * camera_from_world;
}

std::optional<LandmarkProjection> project_landmark(const RigidTransform& world_from_camera,
                                                   const RigidTransform& world_from_anchor,
                                                   const Eigen::Vector2d& bearing,
                                                   double inverse_depth) {
  const SightLine line = sight_line(world_from_camera, world_from_anchor, bearing, inverse_depth);
  if (!(line.in_camera.z() > kNearest)) return std::nullopt;
  LandmarkProjection out;
  out.bearing = line.in_camera.hnormalized();
  out.by_direction = bearing_by_direction(world_from_camera.rotation.conjugate().toRotationMatrix(),
                                          line.in_camera);
  out.by_pose << out.by_direction * skew(line.direction), -inverse_depth * out.by_direction;
  Eigen::Matrix3d of_landmark;
  of_landmark << world_from_anchor.rotation.toRotationMatrix().leftCols<2>(), line.to_anchor;
  out.by_landmark = out.by_direction * of_landmark;
  return out;
}

std::optional<Innovation<2>> landmark_innovation(const FusionState& state, const Landmark& landmark,
                                                 int column, const Eigen::Vector2d& seen,
                                                 const Eigen::Matrix2d& covariance) {
  using Index = FusionIndex;
  const auto view = project_landmark(state.world_from_camera, state.world_from_anchor,
                                     landmark.bearing, landmark.inverse_depth);
  if (!view) return std::nullopt;
  const Eigen::Vector3d beside = state.world_from_anchor.rotation * landmark.bearing.homogeneous();
  Innovation<2> innovation{.residual = seen - view->bearing, .H = {}, .noise = covariance};
  innovation.H.add(Index::kRotation, view->by_pose.leftCols<3>());
  innovation.H.add(Index::kPosition, view->by_pose.rightCols<3>());
  innovation.H.add(Index::kAnchorRotation, -view->by_direction * skew(beside));
  innovation.H.add(Index::kAnchorPosition, -view->by_pose.rightCols<3>());
  innovation.H.add(column, view->by_landmark);
  return innovation;
}

std::optional<LandmarkFromCamera> landmark_from_camera(const FusionState& state,
                                                       const Landmark& landmark, int column) {
  using Index = FusionIndex;
  const SightLine line = sight_line(state, landmark);
  const double z = line.in_camera.z();
  if (!(z > kNearest)) return std::nullopt;
  const Eigen::RowVector3d ahead =
      state.world_from_camera.rotation.toRotationMatrix().col(2).transpose();
  const double inverse_depth = landmark.inverse_depth / z;
  // d(rho / z) = d(rho) / z - rho / z^2 d(z)
  const Eigen::RowVector3d J = -inverse_depth / z * ahead;
  Eigen::RowVector3d of_landmark;
  of_landmark << J * state.world_from_anchor.rotation.toRotationMatrix().leftCols<2>(),
      J * line.to_anchor + 1 / z;
  LandmarkFromCamera out{
      .bearing = line.in_camera.hnormalized(), .inverse_depth = inverse_depth, .by_error = {}};
  out.by_error.add(Index::kRotation, J * skew(line.direction));
  out.by_error.add(Index::kPosition, -landmark.inverse_depth * J);
  out.by_error.add(Index::kAnchorRotation, -J * skew(line.beside));
  out.by_error.add(Index::kAnchorPosition, landmark.inverse_depth * J);
  out.by_error.add(column, of_landmark);
  return out;
}

Eigen::Matrix2d product_covariance(const FusionState& state, const Landmark& landmark,
                                   const Eigen::Matrix3d& displacement_covariance,
                                   double inverse_depth_variance) {
  const SightLine line = sight_line(state, landmark);
  const Eigen::Matrix<double, 2, 3> J = view_by_direction(state, line);
  return inverse_depth_variance * J * displacement_covariance * J.transpose();
}

}  // namespace stillkite
