#include <algorithm>
#include <cmath>

#include "estimation/fusion/fusion_filter.hpp"
#include "estimation/fusion/landmark_model.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;

// Of the landmarks a fifth is nearer. 0 of none.
double inverse_depth_of_near(const std::vector<Landmark>& landmarks) {
  if (landmarks.empty()) return 0;
  std::vector<double> depths;
  depths.reserve(landmarks.size());
  for (const Landmark& landmark : landmarks) depths.push_back(landmark.inverse_depth);
  const auto near = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() * 4 / 5);
  std::nth_element(depths.begin(), near, depths.end());
  return *near;
}

}  // namespace

// What a window is off by lasts while the image around it stays the same, and is another where
// near things have moved before far ones: a first-order Gauss-Markov process of the way, in depths
// of what is near, about the bearing in the reference. Further away it lasts the longer, for what
// grows with the way is alike all along.
void FusionFilter::age_windows(std::span<const FeatureView> seen) {
  constexpr double kLonger = 4;
  const int n = size();
  const Eigen::Vector3d way =
      state_.world_from_camera.translation - state_.world_from_anchor.translation;
  const double near = inverse_depth_of_near(landmarks_);
  for (const FeatureView& view : seen) {
    const std::optional<std::size_t> i = landmark_of(view.feature);
    if (!i) continue;
    Landmark& landmark = landmarks_[*i];
    const double to_depths = std::max({near, landmark.inverse_depth, 0.0});
    const double moved = to_depths * (way - landmark.way).norm();
    const double away = to_depths * std::min(way.norm(), landmark.way.norm());
    const double kept = std::exp(-moved / (config_.window_error_way + kLonger * away));
    landmark.way = way;
    landmark.bearing = landmark.reference + kept * (landmark.bearing - landmark.reference);
    const int column = Index::landmark(*i);
    P_.block(column, 0, 2, n) *= kept;
    P_.block(0, column, n, 2) *= kept;
    P_.block<2, 2>(column, column) += (1 - square(kept)) * square(config_.window_error_ratio) *
                                      window_growth(config_, landmark.inverse_depth * way) *
                                      view.covariance;
  }
}

// Since the anchor, map units, world axes.
Eigen::Matrix3d FusionFilter::displacement_covariance() const {
  constexpr int p = Index::kPosition;
  constexpr int a = Index::kAnchorPosition;
  return P_.block<3, 3>(p, p) + P_.block<3, 3>(a, a) - P_.block<3, 3>(p, a) - P_.block<3, 3>(a, p);
}

// What way and depth are not known to moves a view by their product, of which the linear update
// knows nothing; it is no noise of a frame but as lasting as they are. Of the depths that a start
// as a whole has told nothing is left to be linearised wrongly.
std::vector<LandmarkView> FusionFilter::landmark_views(std::span<const FeatureView> seen) const {
  const Eigen::Matrix3d lasting_way = config_.depth_correlated_frames * displacement_covariance();
  std::vector<LandmarkView> views;
  views.reserve(landmarks_.size());
  for (const FeatureView& view : seen) {
    const std::optional<std::size_t> i = landmark_of(view.feature);
    if (!i) continue;
    const Landmark& landmark = landmarks_[*i];
    const int depth = Index::landmark(*i) + 2;
    const Eigen::Matrix2d usual =
        window_growth(config_, landmark.inverse_depth * landmark.way) * view.covariance;
    Eigen::Matrix2d product = Eigen::Matrix2d::Zero();
    if (!landmark.is_of_start) {
      product = product_covariance(state_, landmark, lasting_way, P_(depth, depth));
    }
    views.push_back({.landmark = *i,
                     .bearing = view.bearing,
                     .covariance = stray_growth(config_, landmark.stray) * usual + product,
                     .usual_covariance = usual + product});
  }
  return views;
}

}  // namespace stillkite
