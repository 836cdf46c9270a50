#include <algorithm>
#include <cmath>

#include "estimation/fusion_filter.hpp"
#include "estimation/landmark_model.hpp"

namespace stillkite {
namespace {

using Index = FusionIndex;
constexpr int kMostRefusals = 5;
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

}  // namespace

// The ground, where the line of sight meets it within a dozen heights; else as far as that.
double FusionFilter::guessed_inverse_depth(const Eigen::Vector2d& bearing) const {
  constexpr double kSteepness = 0.3;
  const RigidTransform& anchor = state_.world_from_anchor;
  const double down = -(anchor.rotation * bearing.homogeneous()).z();
  return std::max(down, kSteepness) / std::max(anchor.translation.z(), 1e-3);
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

// Map units.
double FusionFilter::height_below_anchor(const Landmark& landmark) const {
  const double down = -(state_.world_from_anchor.rotation * landmark.bearing.homogeneous()).z();
  return down / landmark.inverse_depth;
}

int FusionFilter::update_ground() {
  // 1. Landmarks below the camera whose depth has shown.
  constexpr double kSteepness = 0.1;
  constexpr double kKnown = 0.1;
  std::vector<double> heights;
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const int column = Index::kLandmarks + 3 * static_cast<int>(i) + 2;
    const double inverse_depth = landmarks_[i].inverse_depth;
    if (!(inverse_depth > 0) || P_(column, column) > square(kKnown * inverse_depth)) continue;
    const double height = height_below_anchor(landmarks_[i]);
    if (height * inverse_depth < kSteepness) continue;
    heights.push_back(height);
    candidates.push_back(i);
  }
  // 2. Nothing is below the ground: it is the lowest level on which several of them lie.
  const std::optional<double> ground = lowest_level(heights);
  if (!ground) return 0;
  // 3. So high the anchor is, by what is known of the start and the way since.
  int count = 0;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    Landmark& landmark = landmarks_[candidates[c]];
    if (landmark.is_on_ground || std::abs(heights[c] / *ground - 1) > kSameLevel) continue;
    const int column = Index::kLandmarks + 3 * static_cast<int>(candidates[c]);
    landmark.is_on_ground = correct(ground_innovation(landmark, column));
    if (landmark.is_on_ground) ++count;
  }
  return count;
}

// h0 exp(-log_height) + s (z_a - z_0) = s down / inverse_depth, s = exp(log_scale)
Innovation<1> FusionFilter::ground_innovation(const Landmark& landmark, int column) const {
  using Row = Eigen::Matrix<double, 1, 1>;
  const double scale = std::exp(state_.log_scale);
  const double known = start_in_world_.z() * std::exp(-state_.log_height);
  const double way = scale * (state_.world_from_anchor.translation.z() - start_in_world_.z());
  const double below = scale * height_below_anchor(landmark);
  Innovation<1> innovation{.residual = Row(known + way - below),
                           .H = {},
                           .noise = Row(square(config_.ground_sigma_ratio * known))};
  const Eigen::Matrix3d R = state_.world_from_anchor.rotation.toRotationMatrix();
  const double per_down = scale / landmark.inverse_depth;
  const Eigen::RowVector3d by_rotation = per_down * skew(R * landmark.bearing.homogeneous()).row(2);
  innovation.H.add(Index::kScale, Eigen::RowVector2d(below - way, known));
  innovation.H.add(Index::kAnchorPosition, Eigen::RowVector3d(0, 0, -scale));
  innovation.H.add(Index::kAnchorRotation, by_rotation);
  innovation.H.add(column, Eigen::RowVector3d(-per_down * R(2, 0), -per_down * R(2, 1),
                                              -below / landmark.inverse_depth));
  return innovation;
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
