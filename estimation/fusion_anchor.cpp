#include <algorithm>
#include <cmath>

#include "estimation/fusion_filter.hpp"
#include "estimation/landmark_model.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
constexpr int kUnnumbered = -1;
// what belongs to a map beside its landmarks: tilt, scale, height, the anchor's pose
constexpr int kMapSize = Index::kKeyframeRotation - Index::kTilt;

}  // namespace

// A landmark that stays in view is the same point: with its depth all that the lengths of the old
// map are known by goes over into the new one.
void FusionFilter::take_anchor() {
  constexpr double kKnown = 0.25;         // a depth to that share; a new guess is as good
  constexpr double kRelief_share = 0.01;  // of depth, between the old feature and the new
  const int n = size();
  // 1. The depths from here, with all that they share with the rest.
  std::vector<Landmark> kept;
  std::vector<SparseRows<1>> rows;
  Eigen::MatrixXd with_all(n, landmarks_.size());
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    if (landmarks_[i].unseen > 0 || landmarks_[i].refused > 0) continue;
    const auto view = landmark_from_camera(state_, landmarks_[i], column_of(i));
    if (!view || !(view->inverse_depth > 0)) continue;
    const Eigen::VectorXd with_this = view->by_error.times_transposed(P_, n);
    const double variance = view->by_error.times(with_this)(0, 0);
    if (!(variance < square(kKnown * view->inverse_depth))) continue;
    with_all.col(static_cast<Eigen::Index>(kept.size())) = with_this;
    rows.push_back(view->by_error);
    kept.push_back({.feature = kUnnumbered,
                    .bearing = view->bearing,
                    .inverse_depth = view->inverse_depth,
                    .is_on_ground = landmarks_[i].is_on_ground});
  }
  const auto count = static_cast<Eigen::Index>(kept.size());
  with_all.conservativeResize(n, count);
  Eigen::MatrixXd depths(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    depths.row(i) = rows[static_cast<std::size_t>(i)].times(with_all);
  }
  if (!landmarks_.empty()) is_first_map_ = false;
  // 2. Nothing else is left of the old map.
  landmarks_ = kept;
  dropped_.clear();
  state_.world_from_anchor = state_.world_from_camera;
  P_.block(0, Index::kLandmarks, size(), size() - Index::kLandmarks).setZero();
  P_.block(Index::kLandmarks, 0, size() - Index::kLandmarks, size()).setZero();
  for (Eigen::Index i = 0; i < count; ++i) {
    const int depth = column_of(static_cast<std::size_t>(i)) + 2;
    P_.col(depth).head<Index::kLandmarks>() = with_all.col(i).head<Index::kLandmarks>();
    P_.row(depth).head<Index::kLandmarks>() = with_all.col(i).head<Index::kLandmarks>();
    for (Eigen::Index j = 0; j < count; ++j) {
      P_(column_of(static_cast<std::size_t>(j)) + 2, depth) = depths(j, i);
    }
    P_(depth, depth) += square(kRelief_share * kept[static_cast<std::size_t>(i)].inverse_depth);
  }
  clone_camera(Index::kAnchorRotation);
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
      const bool is_taken =
          std::any_of(landmarks_.begin(), landmarks_.end(),
                      [&](const Landmark& l) { return l.feature == view.feature; });
      if (beside > distance || is_taken) continue;
      distance = beside;
      nearest = &view;
    }
    if (!nearest) {
      remove_landmark(i);
      continue;
    }
    landmark.feature = nearest->feature;
    landmark.bearing = nearest->bearing;
    P_.block<2, 2>(column_of(i), column_of(i)) = nearest->covariance;
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

void FusionFilter::restore(const FusionMap& map) {
  change_unit(std::exp(state_.log_scale - map.log_scale));
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
}

// Of the camera's and the keyframe's way and of the velocity: so many of the new are one of the
// old.
void FusionFilter::change_unit(double ratio) {
  for (RigidTransform* pose : {&state_.world_from_camera, &state_.world_from_keyframe}) {
    pose->translation = start_in_world_ + ratio * (pose->translation - start_in_world_);
  }
  state_.velocity_in_world *= ratio;
  for (const int first : {Index::kPosition, Index::kVelocity, Index::kKeyframePosition}) {
    P_.middleRows<3>(first) *= ratio;
    P_.middleCols<3>(first) *= ratio;
  }
}

}  // namespace stillkite
