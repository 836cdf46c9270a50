#include <Eigen/Eigenvalues>
#include <cmath>

#include "estimation/fusion/fusion_filter.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
constexpr double kVaguestTilt_rad = 0.3;

Eigen::Vector3d normal_of(const FusionState& state) {
  return -(state.world_from_keyframe.rotation.conjugate() * up(state).normalized());
}

// Of the ground's normal from that of a keyframe's view, about its tilt axes.
struct KeyframeTilt {
  Eigen::Vector2d tilt_rad;
  Eigen::Matrix<double, 2, 3> by_keyframe_rotation;
  Eigen::Matrix2d by_tilt;
};

// The ground's normal n = -R_k^T up, by a turn of that of the view about the tilt axes A:
//   tilt = A^T (n_view x n),   d tilt = -A^T R_k^T (e_k - delta), level parts alone
KeyframeTilt keyframe_tilt(const FusionState& state, const KeyframeView& view) {
  const Eigen::Matrix3d R_t = state.world_from_keyframe.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d normal = normal_of(state);
  const Eigen::Matrix<double, 2, 2> level = view.tilt_axes.transpose() * R_t.leftCols<2>();
  KeyframeTilt out{.tilt_rad = view.tilt_axes.transpose() * view.motion.normal.cross(normal),
                   .by_keyframe_rotation = Eigen::Matrix<double, 2, 3>::Zero(),
                   .by_tilt = level};
  out.by_keyframe_rotation.leftCols<2>() = -level;
  return out;
}

}  // namespace

Eigen::Vector3d FusionFilter::normal_in_keyframe() const {
  return normal_of(state_);
}

void FusionFilter::take_keyframe() {
  start_.remember([](FusionFilter& filter) { filter.take_keyframe(); });
  state_.world_from_keyframe = state_.world_from_camera;
  clone(Index::kRotation, 6, Index::kKeyframeRotation);
}

// From the keyframe (R_k, p_k) at the height h_k, to the camera (R, p):
//   Q = R^T R_k,   t = R^T (p_k - p) / h_k
// as the windows have it for the normal that the filter has.
bool FusionFilter::update_keyframe_view(const KeyframeView& view, double correlated_frames) {
  start_.remember(
      [=](FusionFilter& filter) { filter.update_keyframe_view(view, correlated_frames); });
  const RigidTransform& keyframe = state_.world_from_keyframe;
  const RigidTransform& camera = state_.world_from_camera;
  const Eigen::Vector3d u = up(state_);
  const double known = start_in_world_.z() * std::exp(-(state_.log_scale + state_.log_height));
  const double h = height(keyframe.translation);
  if (!(h > 0)) return false;
  const KeyframeTilt tilt = keyframe_tilt(state_, view);
  PlaneMotionStep to_normal;
  to_normal << view.likelihood.motion_by_tilt * tilt.tilt_rad, tilt.tilt_rad;
  const PlaneMotion seen = apply(view.motion, to_normal, view.tilt_axes);
  const Eigen::Matrix3d R_t = camera.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d d = (keyframe.translation - camera.translation) / h;
  const Eigen::Vector3d t = R_t * d;
  const Eigen::Quaterniond Q = camera.rotation.conjugate() * keyframe.rotation;
  const Eigen::Quaterniond turn = seen.rotation * Q.conjugate();
  Innovation<6> innovation{
      .residual = {}, .H = {}, .noise = correlated_frames * view.likelihood.covariance};
  innovation.residual << seen.translation - turn * t, so3_log(turn);
  innovation.noise.topLeftCorner<3, 3>().diagonal().array() +=
      square(config_.keyframe_view_sigma_ratio) * t.squaredNorm();

  using Matrix63 = Eigen::Matrix<double, 6, 3>;
  const Matrix63 by_rotation = (Matrix63() << Eigen::Matrix3d::Zero(), -R_t).finished();
  Matrix63 by_keyframe_rotation = (Matrix63() << R_t * skew(d), R_t).finished();
  const Matrix63 by_position = (Matrix63() << -R_t / h, Eigen::Matrix3d::Zero()).finished();
  const Matrix63 by_keyframe_position =
      (Matrix63() << (R_t - t * u.transpose()) / h, Eigen::Matrix3d::Zero()).finished();
  Eigen::Matrix<double, 6, 2> by_height;
  by_height << t * (known / h) * Eigen::RowVector2d::Ones(), Eigen::Matrix<double, 3, 2>::Zero();
  const Eigen::Vector3d way = keyframe.translation - start_in_world_;
  Eigen::Matrix<double, 6, 2> by_tilt;
  by_tilt << -t / h * Eigen::RowVector2d(-way.y(), way.x()), Eigen::Matrix<double, 3, 2>::Zero();
  by_keyframe_rotation -= view.likelihood.motion_by_tilt * tilt.by_keyframe_rotation;
  by_tilt -= view.likelihood.motion_by_tilt * tilt.by_tilt;
  innovation.H.add(Index::kRotation, by_rotation);
  innovation.H.add(Index::kPosition, by_position);
  innovation.H.add(Index::kKeyframeRotation, by_keyframe_rotation);
  innovation.H.add(Index::kKeyframePosition, by_keyframe_position);
  innovation.H.add(Index::kScale, by_height);
  innovation.H.add(Index::kTilt, by_tilt);
  if (!correct(innovation)) return false;
  update_keyframe_tilt(view, correlated_frames);
  return true;
}

// Which normal suits the windows, one direction after the other: of a way ahead they tell pitch
// alone.
void FusionFilter::update_keyframe_tilt(const KeyframeView& view, double correlated_frames) {
  using Row = Eigen::Matrix<double, 1, 1>;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> W(view.likelihood.tilt_information);
  for (int k = 0; k < 2; ++k) {
    const double information = W.eigenvalues()[k];
    const double variance = correlated_frames / information;
    if (!(information > 0 && variance < square(kVaguestTilt_rad))) continue;
    const KeyframeTilt tilt = keyframe_tilt(state_, view);
    const Eigen::RowVector2d along = W.eigenvectors().col(k).transpose();
    Innovation<1> innovation{
        .residual =
            Row(along * (view.likelihood.tilt_information_rad / information - tilt.tilt_rad)),
        .H = {},
        .noise = Row(variance)};
    innovation.H.add(Index::kKeyframeRotation, along * tilt.by_keyframe_rotation);
    innovation.H.add(Index::kTilt, along * tilt.by_tilt);
    correct(innovation);
  }
}

}  // namespace stillkite
