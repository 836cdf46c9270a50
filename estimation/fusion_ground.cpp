#include <algorithm>
#include <cmath>

#include "estimation/fusion_filter.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
constexpr double kSameLevel = 0.04;

// The largest height on which, within kSameLevel of it, several lie; that of their middle.
std::optional<double> lowest_level(std::vector<double> heights) {
  constexpr std::size_t kSeveral = 5;
  std::sort(heights.begin(), heights.end());
  for (std::size_t last = heights.size(); last-- > kSeveral - 1;) {
    const double highest = heights[last + 1 - kSeveral];
    if (highest > (1 - kSameLevel) * heights[last]) return heights[last - kSeveral / 2];
  }
  return std::nullopt;
}

// d(up . way)/d(tilt)
Eigen::RowVector2d up_by_tilt(const Eigen::Vector3d& way) {
  return {-way.y(), way.x()};
}

}  // namespace

// Of a place over the ground, map units: that of the start, as far as it is known, and the way up.
double FusionFilter::height(const Eigen::Vector3d& position) const {
  return start_in_world_.z() * std::exp(-(state_.log_scale + state_.log_height)) +
         up(state_).dot(position - start_in_world_);
}

// Map units.
double FusionFilter::height_below_anchor(const Landmark& landmark) const {
  const Eigen::Vector3d beside = state_.world_from_anchor.rotation * landmark.bearing.homogeneous();
  return -up(state_).dot(beside) / landmark.inverse_depth;
}

int FusionFilter::update_ground(bool is_flat) {
  // 1. Landmarks below the camera; their depth has shown, or is the ground's anyway.
  constexpr double kSteepness = 0.1;
  constexpr double kKnown = 0.1;
  std::vector<double> heights;
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const int column = Index::kLandmarks + 3 * static_cast<int>(i) + 2;
    const double inverse_depth = landmarks_[i].inverse_depth;
    const bool is_known = inverse_depth > 0 && P_(column, column) <= square(kKnown * inverse_depth);
    if (!is_flat && !is_known) continue;
    const double height = height_below_anchor(landmarks_[i]);
    if (height * inverse_depth < kSteepness) continue;
    heights.push_back(height);
    candidates.push_back(i);
  }
  // 2. Nothing is below the ground: it is the lowest level on which several of them lie.
  const std::optional<double> ground = lowest_level(heights);
  if (!is_flat && !ground) return 0;
  // 3. So high the anchor is, by what is known of the start and the way since.
  int count = 0;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    Landmark& landmark = landmarks_[candidates[c]];
    const bool is_on_it = is_flat || std::abs(heights[c] / *ground - 1) <= kSameLevel;
    if (landmark.is_on_ground || !is_on_it) continue;
    const int column = Index::kLandmarks + 3 * static_cast<int>(candidates[c]);
    landmark.is_on_ground = correct(ground_innovation(landmark, column));
    if (landmark.is_on_ground) ++count;
  }
  return count;
}

// The anchor's height is that of the way down to the landmark: with b = R_a (bearing, 1), in map
// units and in shares of the known height h0,
//   h0 exp(-log_height - log_scale) + up . (p_a - p_0) + up . b / inverse_depth = 0
Innovation<1> FusionFilter::ground_innovation(const Landmark& landmark, int column) const {
  using Row = Eigen::Matrix<double, 1, 1>;
  const Eigen::Vector3d u = up(state_);
  const Eigen::Matrix3d R = state_.world_from_anchor.rotation.toRotationMatrix();
  const Eigen::Vector3d beside = R * landmark.bearing.homogeneous();
  const Eigen::Vector3d way = state_.world_from_anchor.translation - start_in_world_;
  const double known = start_in_world_.z() * std::exp(-(state_.log_scale + state_.log_height));
  const double depth = 1 / landmark.inverse_depth;
  Innovation<1> innovation{.residual = Row(known + u.dot(way + depth * beside)),
                           .H = {},
                           .noise = Row(square(config_.ground_sigma_ratio * known))};
  innovation.H.add(Index::kScale, Eigen::RowVector2d(known, known));
  innovation.H.add(Index::kTilt, -up_by_tilt(way + depth * beside));
  innovation.H.add(Index::kAnchorPosition, -u.transpose());
  innovation.H.add(Index::kAnchorRotation, depth * u.transpose() * skew(beside));
  innovation.H.add(column, Eigen::RowVector3d(-depth * u.dot(R.col(0)), -depth * u.dot(R.col(1)),
                                              depth * depth * u.dot(beside)));
  return innovation;
}

// From the keyframe (R_k, p_k) at the height h_k, to the camera (R, p):
//   Q = R^T R_k,   t = R^T (p_k - p) / h_k
bool FusionFilter::update_keyframe_view(const PlaneMotion& seen, const Matrix6d& covariance) {
  const RigidTransform& keyframe = state_.world_from_keyframe;
  const RigidTransform& camera = state_.world_from_camera;
  const Eigen::Vector3d u = up(state_);
  const double known = start_in_world_.z() * std::exp(-(state_.log_scale + state_.log_height));
  const double h = height(keyframe.translation);
  if (!(h > 0)) return false;
  const Eigen::Matrix3d R_t = camera.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d d = (keyframe.translation - camera.translation) / h;
  const Eigen::Vector3d t = R_t * d;
  const Eigen::Quaterniond Q = camera.rotation.conjugate() * keyframe.rotation;
  const Eigen::Quaterniond turn = seen.rotation * Q.conjugate();
  Innovation<6> innovation{.residual = {}, .H = {}, .noise = covariance};
  innovation.residual << seen.translation - turn * t, so3_log(turn);
  innovation.noise.topLeftCorner<3, 3>().diagonal().array() +=
      square(config_.keyframe_view_sigma_ratio) * t.squaredNorm();

  using Matrix63 = Eigen::Matrix<double, 6, 3>;
  const Matrix63 by_rotation = (Matrix63() << Eigen::Matrix3d::Zero(), -R_t).finished();
  const Matrix63 by_keyframe_rotation = (Matrix63() << R_t * skew(d), R_t).finished();
  const Matrix63 by_position = (Matrix63() << -R_t / h, Eigen::Matrix3d::Zero()).finished();
  const Matrix63 by_keyframe_position =
      (Matrix63() << (R_t - t * u.transpose()) / h, Eigen::Matrix3d::Zero()).finished();
  Eigen::Matrix<double, 6, 2> by_height;
  by_height << t * (known / h) * Eigen::RowVector2d::Ones(), Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Matrix<double, 6, 2> by_tilt;
  by_tilt << -t / h * up_by_tilt(keyframe.translation - start_in_world_),
      Eigen::Matrix<double, 3, 2>::Zero();
  innovation.H.add(Index::kRotation, by_rotation);
  innovation.H.add(Index::kPosition, by_position);
  innovation.H.add(Index::kKeyframeRotation, by_keyframe_rotation);
  innovation.H.add(Index::kKeyframePosition, by_keyframe_position);
  innovation.H.add(Index::kScale, by_height);
  innovation.H.add(Index::kTilt, by_tilt);
  return correct(innovation);
}

}  // namespace stillkite
