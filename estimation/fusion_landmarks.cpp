#include <algorithm>
#include <cmath>

#include "estimation/fusion_filter.hpp"
#include "estimation/landmark_model.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
constexpr int kMostRefusals = 5;

}  // namespace

// The ground, where the line of sight meets it within a dozen heights; else as far as that.
double FusionFilter::guessed_inverse_depth(const Eigen::Vector2d& bearing) const {
  constexpr double kSteepness = 0.3;
  const RigidTransform& anchor = state_.world_from_anchor;
  const double down = -up(state_).dot(anchor.rotation * bearing.homogeneous());
  return std::max(down, kSteepness) / std::max(height(anchor.translation), 1e-3);
}

void FusionFilter::add_landmark(int feature, const Eigen::Vector2d& bearing, double sigma) {
  if (static_cast<int>(landmarks_.size()) >= config_.landmarks) return;
  const int column = size();
  const double inverse_depth = guessed_inverse_depth(bearing);
  landmarks_.push_back({.feature = feature, .bearing = bearing, .inverse_depth = inverse_depth});
  P_.block(column, 0, 3, column + 3).setZero();
  P_.block(0, column, column, 3).setZero();
  P_(column, column) = P_(column + 1, column + 1) = square(sigma);
  P_(column + 2, column + 2) = square(config_.inverse_depth_sigma_ratio * inverse_depth);
}

FusionMap FusionFilter::map() const {
  const int landmarks = size() - Index::kLandmarks;
  FusionMap map{state_.world_from_anchor, landmarks_,
                Eigen::MatrixXd(6 + landmarks, 6 + landmarks)};
  map.covariance << P_.block<6, 6>(Index::kAnchorRotation, Index::kAnchorRotation),
      P_.block(Index::kAnchorRotation, Index::kLandmarks, 6, landmarks),
      P_.block(Index::kLandmarks, Index::kAnchorRotation, landmarks, 6),
      P_.block(Index::kLandmarks, Index::kLandmarks, landmarks, landmarks);
  return map;
}

void FusionFilter::restore(const FusionMap& map) {
  state_.world_from_anchor = map.world_from_anchor;
  landmarks_ = map.landmarks;
  for (Landmark& landmark : landmarks_) landmark.refused = 0;
  const int n = size();
  const int landmarks = n - Index::kLandmarks;
  P_.block(Index::kAnchorRotation, 0, 6, n).setZero();
  P_.block(0, Index::kAnchorRotation, n, 6).setZero();
  P_.block(Index::kLandmarks, 0, landmarks, n).setZero();
  P_.block(0, Index::kLandmarks, n, landmarks).setZero();
  P_.block<6, 6>(Index::kAnchorRotation, Index::kAnchorRotation) =
      map.covariance.topLeftCorner<6, 6>();
  P_.block(Index::kAnchorRotation, Index::kLandmarks, 6, landmarks) =
      map.covariance.topRightCorner(6, landmarks);
  P_.block(Index::kLandmarks, Index::kAnchorRotation, landmarks, 6) =
      map.covariance.bottomLeftCorner(landmarks, 6);
  P_.block(Index::kLandmarks, Index::kLandmarks, landmarks, landmarks) =
      map.covariance.bottomRightCorner(landmarks, landmarks);
}

bool FusionFilter::update_landmark(int feature, const Eigen::Vector2d& seen, double sigma) {
  const auto found = std::find_if(landmarks_.begin(), landmarks_.end(),
                                  [&](const Landmark& l) { return l.feature == feature; });
  if (found == landmarks_.end()) return false;
  const int column = Index::kLandmarks + 3 * static_cast<int>(found - landmarks_.begin());
  const std::optional<Innovation<2>> innovation =
      landmark_innovation(state_, *found, column, seen, sigma);
  const bool taken = innovation && correct(*innovation);
  found->refused = taken ? 0 : found->refused + 1;
  return taken;
}

void FusionFilter::drop_refused() {
  for (std::size_t i = landmarks_.size(); i-- > 0;) {
    if (landmarks_[i].refused >= kMostRefusals) remove_landmark(i);
  }
}

void FusionFilter::remove_landmark(std::size_t i) {
  const int n = size();
  const int column = Index::kLandmarks + 3 * static_cast<int>(i);
  const int after = n - column - 3;
  P_.block(column, 0, after, n) = P_.block(column + 3, 0, after, n).eval();
  P_.block(0, column, n, after) = P_.block(0, column + 3, n, after).eval();
  landmarks_.erase(landmarks_.begin() + static_cast<std::ptrdiff_t>(i));
}

}  // namespace stillkite
