#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "estimation/fusion/fusion_filter.hpp"
#include "estimation/fusion/landmark_model.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
constexpr int kUnnumbered = -1;
// what belongs to a map beside its landmarks: tilt, scale, height, the anchor's pose
constexpr int kMapSize = Index::kKeyframeRotation - Index::kTilt;

// Landmarks as they would be with the camera for their anchor, and their inverse depths'
// covariances with the state and with each other.
struct InheritedDepths {
  std::vector<Landmark> landmarks;
  Eigen::MatrixXd with_state;
  Eigen::MatrixXd covariance;
};

// Of what is in view, with all that the depths share with the state and with each other.
InheritedDepths depths_from_camera(const FusionState& state, const std::vector<Landmark>& landmarks,
                                   const Eigen::MatrixXd& P) {
  constexpr double kKnown = 0.25;         // a depth to that share; a new guess is as good
  constexpr double kRelief_share = 0.01;  // of depth, between the old feature and the new
  const int n = Index::landmark(landmarks.size());
  InheritedDepths out{.landmarks = {}, .with_state = Eigen::MatrixXd(n, landmarks.size())};
  std::vector<SparseRows<1>> rows;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (landmarks[i].unseen > 0 || landmarks[i].refused > 0) continue;
    const auto view = landmark_from_camera(state, landmarks[i], Index::landmark(i));
    if (!view || !(view->inverse_depth > 0)) continue;
    const Eigen::VectorXd with_state = view->by_error.times_transposed(P, n);
    const double variance = view->by_error.times(with_state)(0, 0);
    if (!(variance < square(kKnown * view->inverse_depth))) continue;
    out.with_state.col(static_cast<Eigen::Index>(rows.size())) = with_state;
    rows.push_back(view->by_error);
    out.landmarks.push_back({.feature = kUnnumbered,
                             .bearing = view->bearing,
                             .reference = view->bearing,
                             .inverse_depth = view->inverse_depth,
                             .is_on_ground = landmarks[i].is_on_ground});
  }
  const auto count = static_cast<Eigen::Index>(rows.size());
  out.with_state.conservativeResize(n, count);
  out.covariance.resize(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out.covariance.row(i) = rows[k].times(out.with_state);
    out.covariance(i, i) += square(kRelief_share * out.landmarks[k].inverse_depth);
  }
  return out;
}

// False for what is not finite.
bool is_within_sigmas(const Eigen::Vector2d& residual, const Eigen::Matrix2d& S, double sigmas) {
  return residual.dot(S.llt().solve(residual)) <= sigmas * sigmas;
}

}  // namespace

// A landmark that stays in view is the same point: with its depth all that the lengths of the old
// map are known by goes over into the new one. Nothing else is left of it.
void FusionFilter::take_anchor() {
  start_.take_anchor();
  start_.remember([](FusionFilter& filter) { filter.take_anchor(); });
  const InheritedDepths kept = depths_from_camera(state_, landmarks_, P_);
  if (!landmarks_.empty()) is_first_map_ = false;
  landmarks_ = kept.landmarks;
  dropped_.clear();
  state_.world_from_anchor = state_.world_from_camera;
  const int n = size();
  P_.block(0, Index::kLandmarks, n, n - Index::kLandmarks).setZero();
  P_.block(Index::kLandmarks, 0, n - Index::kLandmarks, n).setZero();
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const int depth = Index::landmark(i) + 2;
    const auto k = static_cast<Eigen::Index>(i);
    P_.col(depth).head<Index::kLandmarks>() = kept.with_state.col(k).head<Index::kLandmarks>();
    P_.row(depth).head<Index::kLandmarks>() = kept.with_state.col(k).head<Index::kLandmarks>();
    for (std::size_t j = 0; j < landmarks_.size(); ++j) {
      P_(Index::landmark(j) + 2, depth) = kept.covariance(static_cast<Eigen::Index>(j), k);
    }
  }
  clone(Index::kRotation, 6, Index::kAnchorRotation);
}

// What is seen there is at that depth; where it is in the new reference is known as of any feature.
void FusionFilter::number_landmarks(std::span<const FeatureView> reference, double most_beside) {
  for (std::size_t i = landmarks_.size(); i-- > 0;) {
    Landmark& landmark = landmarks_[i];
    if (landmark.feature != kUnnumbered) continue;
    const FeatureView* nearest = nullptr;
    double distance = most_beside;
    for (const FeatureView& view : reference) {
      const double beside = (view.bearing - landmark.bearing).norm();
      if (beside > distance || landmark_of(view.feature)) continue;
      distance = beside;
      nearest = &view;
    }
    if (!nearest) {
      remove_landmark(i);
      continue;
    }
    landmark.feature = nearest->feature;
    landmark.bearing = landmark.reference = nearest->bearing;
    P_.block<2, 2>(Index::landmark(i), Index::landmark(i)) = nearest->covariance;
  }
}

FusionMap FusionFilter::map() const {
  const int landmarks = size() - Index::kLandmarks;
  FusionMap map{state_.gravity_tilt_rad,
                state_.log_scale,
                state_.log_height,
                state_.world_from_anchor,
                landmarks_,
                dropped_,
                Eigen::MatrixXd(kMapSize + landmarks, kMapSize + landmarks)};
  map.covariance << P_.block<kMapSize, kMapSize>(Index::kTilt, Index::kTilt),
      P_.block(Index::kTilt, Index::kLandmarks, kMapSize, landmarks),
      P_.block(Index::kLandmarks, Index::kTilt, landmarks, kMapSize),
      P_.block(Index::kLandmarks, Index::kLandmarks, landmarks, landmarks);
  return map;
}

bool FusionFilter::may_be_seen(const FusionMap& map, std::span<const FeatureView> seen,
                               const RigidTransform& world_from_camera_m,
                               const Matrix6d& covariance, double sigmas) const {
  const double unit_m = std::exp(map.log_scale);
  const RigidTransform camera_from_world = world_from_camera_m.inverse();
  const Eigen::Matrix3d R = camera_from_world.rotation.toRotationMatrix();
  const RigidTransform camera_from_anchor =
      camera_from_world *
      RigidTransform{map.world_from_anchor.rotation,
                     start_m_ + unit_m * (map.world_from_anchor.translation - start_in_world_)};
  int met = 0, expected = 0;
  for (const FeatureView& view : seen) {
    const auto found = std::find_if(map.landmarks.begin(), map.landmarks.end(),
                                    [&](const Landmark& l) { return l.feature == view.feature; });
    if (found == map.landmarks.end() || !(found->inverse_depth > 0)) continue;
    const auto depth = kMapSize + 3 * std::distance(map.landmarks.begin(), found) + 2;
    const Eigen::Vector3d ray = unit_m / found->inverse_depth * found->bearing.homogeneous();
    const Eigen::Vector3d point = camera_from_anchor * ray;
    ++expected;
    if (!(point.z() > 0)) continue;
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << 1, 0, -point.x() / point.z(), 0, 1, -point.y() / point.z();
    by_point /= point.z();
    Eigen::Matrix<double, 3, 6> by_pose;
    by_pose << -R, skew(point) * R;
    const Eigen::Vector2d by_depth =
        by_point * (camera_from_anchor.rotation * ray) / found->inverse_depth;
    const Eigen::Matrix<double, 2, 6> J = by_point * by_pose;
    const Eigen::Matrix2d S = view.covariance + J * covariance * J.transpose() +
                              map.covariance(depth, depth) * by_depth * by_depth.transpose();
    met += is_within_sigmas(view.bearing - point.hnormalized(), S, sigmas);
  }
  return 2 * met >= expected;
}

// What is known of way and velocity is known in metres, whatever a map's unit is, and as far as it
// was due to the scale it is due to the map's. With w the way (or velocity) in units, e_s the error
// of the unit's logarithm and b e_s what of an error in metres is due to it, that in units is the
// rest + (b - w) e_s.
void FusionFilter::restore(const FusionMap& map) {
  start_.forget();
  add_scale_error(ways());
  change_unit(std::exp(state_.log_scale - map.log_scale));
  constexpr int kScaleOfMap = Index::kScale - Index::kTilt;
  const double map_variance = map.covariance(kScaleOfMap, kScaleOfMap);
  Eigen::VectorXd due =
      P_.col(Index::kScale).head(size()) / std::max(map_variance, P_(Index::kScale, Index::kScale));
  due.segment<kMapSize>(Index::kTilt).setZero();
  due.tail(size() - Index::kLandmarks).setZero();
  P_.topLeftCorner(size(), size()) -= map_variance * due * due.transpose();
  due -= ways();
  state_.gravity_tilt_rad = map.gravity_tilt_rad;
  state_.log_scale = map.log_scale;
  state_.log_height = map.log_height;
  state_.world_from_anchor = map.world_from_anchor;
  landmarks_ = map.landmarks;
  dropped_ = map.dropped;
  for (Landmark& landmark : landmarks_) landmark.refused = landmark.unseen = 0;
  const int n = size();
  const int landmarks = n - Index::kLandmarks;
  const auto put = [&](int first, int count, int from) {
    P_.block(first, 0, count, n).setZero();
    P_.block(0, first, n, count).setZero();
    P_.block(first, first, count, count) = map.covariance.block(from, from, count, count);
  };
  put(Index::kTilt, kMapSize, 0);
  put(Index::kLandmarks, landmarks, kMapSize);
  P_.block(Index::kTilt, Index::kLandmarks, kMapSize, landmarks) =
      map.covariance.topRightCorner(kMapSize, landmarks);
  P_.block(Index::kLandmarks, Index::kTilt, landmarks, kMapSize) =
      map.covariance.bottomLeftCorner(landmarks, kMapSize);
  due.conservativeResizeLike(Eigen::VectorXd::Zero(n));
  add_scale_error(due);
}

// Of the camera's, the keyframe's and the last step's way, and the velocity, map units.
Eigen::VectorXd FusionFilter::ways() const {
  Eigen::VectorXd ways = Eigen::VectorXd::Zero(size());
  ways.segment<3>(Index::kPosition) = state_.world_from_camera.translation - start_in_world_;
  ways.segment<3>(Index::kVelocity) = state_.velocity_in_world;
  ways.segment<3>(Index::kKeyframePosition) =
      state_.world_from_keyframe.translation - start_in_world_;
  ways.segment<3>(Index::kStepStart) = state_.step_start - start_in_world_;
  return ways;
}

// So many times that of the unit's logarithm, to each.
void FusionFilter::add_scale_error(const Eigen::VectorXd& times) {
  auto P = P_.topLeftCorner(size(), size());
  const Eigen::VectorXd shared = P.col(Index::kScale);
  P += times * shared.transpose() + shared * times.transpose() +
       shared[Index::kScale] * times * times.transpose();
}

// Of the camera's, the keyframe's and the last step's way and of the velocity: so many of the new
// are one of the old.
void FusionFilter::change_unit(double ratio) {
  for (Eigen::Vector3d* place : {&state_.world_from_camera.translation,
                                 &state_.world_from_keyframe.translation, &state_.step_start}) {
    *place = start_in_world_ + ratio * (*place - start_in_world_);
  }
  state_.velocity_in_world *= ratio;
  for (const int first :
       {Index::kPosition, Index::kVelocity, Index::kKeyframePosition, Index::kStepStart}) {
    P_.middleRows<3>(first) *= ratio;
    P_.middleCols<3>(first) *= ratio;
  }
}

}  // namespace stillkite
