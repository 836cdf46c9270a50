#include "estimation/ego_motion/least_squares.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/median.hpp"

namespace stillkite {
std::string name_direction(const Vector6d& scaled_direction) {
  constexpr std::array<const char*, 6> kNames{"v_x", "v_y", "v_z", "w_x", "w_y", "w_z"};
  constexpr double kMinRatio = 0.1;
  std::array<int, 6> order{0, 1, 2, 3, 4, 5};
  const Vector6d ratio = scaled_direction.cwiseAbs2();
  std::sort(order.begin(), order.end(), [&](int a, int b) { return ratio(a) > ratio(b); });
  std::string names;
  for (const int axis : order) {
    if (!(ratio(axis) > kMinRatio * ratio.sum())) break;
    if (!names.empty()) names += ", ";
    names += kNames[static_cast<std::size_t>(axis)];
  }
  return names;
}

EgoMotionSolver::EgoMotionSolver(const Camera& camera, const LeastSquaresConfig& config)
    : config_(config), row_maker_(camera), fitter_(config) {}

EgoMotion EgoMotionSolver::solve(std::span<const FlowVector> vectors, const GroundPlane& ground,
                                 double dt_s, const std::optional<TwistPrior>& prior) {
  const bool use_information = config_.weighting != Weighting::plain;
  const FlowRows& rows = row_maker_.make(vectors, ground, dt_s, use_information);
  EgoMotion out;
  int on_ground = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.max_information[i] == 0) continue;
    ++out.vectors;
    on_ground += rows.inverse_depth[i] > 0 ? 1 : 0;
  }
  out.verdict = Verdict::too_little_texture;
  if (out.vectors < config_.min_windows) return out;
  out.verdict = Verdict::horizon;
  if (on_ground < config_.min_windows) return out;

  const TwistFit fit = fitter_.fit(rows, prior);
  out.condition = fit.conditioning.condition;
  out.weakest = fit.conditioning.weakest;
  compute_residuals(rows, out);
  out.verdict = classify(out);
  if (out.verdict == Verdict::ok) {
    out.twist = Twist::from_vector(fit.twist);
    out.covariance = covariance_of(fit, config_.covariance, prior);
  }
  return out;
}

Verdict EgoMotionSolver::classify(const EgoMotion& motion) const {
  if (!(motion.condition <= config_.max_condition)) return Verdict::ill_conditioned;
  if (!(motion.inlier_ratio >= config_.min_inlier_ratio)) return Verdict::too_few_inliers;
  return Verdict::ok;
}

// Pixel residuals along the best observed direction: flow along an edge is unobservable.
void EgoMotionSolver::compute_residuals(const FlowRows& rows, EgoMotion& motion) {
  const std::span<const double> squared_distances = fitter_.squared_distances();
  squared_px_.clear();
  int inliers = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.max_information[i] == 0) continue;
    squared_px_.push_back(squared_distances[i] / rows.max_information[i]);
    inliers += squared_px_.back() <= config_.inlier_px * config_.inlier_px ? 1 : 0;
  }
  motion.inlier_ratio = inliers / static_cast<double>(squared_px_.size());
  motion.residual_px = std::sqrt(upper_median(squared_px_)) / kRayleighMedian;
}

}  // namespace stillkite
