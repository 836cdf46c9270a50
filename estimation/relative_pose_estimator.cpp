#include "estimation/relative_pose_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/epipolar_error.hpp"
#include "estimation/essential_decomposition.hpp"
#include "estimation/essential_ransac.hpp"
#include "estimation/random_draws.hpp"
#include "estimation/sampson_refinement.hpp"

namespace stillkite {
namespace {

std::vector<int> shuffled_finite_pairs(std::span<const BearingPair> pairs, int seed) {
  std::vector<int> order;
  order.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].reference.allFinite() && pairs[i].current.allFinite()) {
      order.push_back(static_cast<int>(i));
    }
  }
  RandomDraws(static_cast<std::uint64_t>(seed)).shuffle(order);
  return order;
}

double robust_sigma(const std::vector<float>& distances, double threshold) {
  std::vector<float> inliers;
  inliers.reserve(distances.size());
  for (const float e : distances) {
    if (e < threshold) inliers.push_back(e);
  }
  if (inliers.empty()) return 0;
  const auto middle = inliers.begin() + static_cast<std::ptrdiff_t>(inliers.size() / 2);
  std::nth_element(inliers.begin(), middle, inliers.end());
  return kSigmaOfMedian * static_cast<double>(*middle);
}

}  // namespace

RelativePoseEstimate estimate_relative_pose(std::span<const BearingPair> pairs, double focal_px,
                                            const RelativePoseConfig& config,
                                            const RelativePoseHints& hints) {
  RelativePoseEstimate estimate;
  estimate.inliers.assign(pairs.size(), 0);
  const double threshold = config.threshold_px / focal_px;
  const std::vector<int> order = shuffled_finite_pairs(pairs, config.seed);
  const BearingColumns columns(pairs, order);
  EssentialFit fit = fit_essential(columns, threshold, config, hints.prior);
  if (!fit.found || fit.inliers < config.min_pairs) return estimate;
  double sigma = robust_sigma(sampson_distances(columns, essential_matrix(fit.pose)), threshold);
  double cutoff = 1.5 * threshold;
  // the noise, and with it the cutoff, comes out smaller as the pose improves
  for (int i = 0; config.refine && i < 10; ++i) {
    const double before = sigma;
    cutoff = std::clamp(kTukeyCutoff * sigma, 1e-9, 1.5 * threshold);
    fit.pose = refine_pose(columns, fit.pose, cutoff, 3);
    sigma = robust_sigma(sampson_distances(columns, essential_matrix(fit.pose)), threshold);
    if (sigma > 0.98 * before) break;
  }
  const Eigen::Matrix3d E = essential_matrix(fit.pose);
  const std::vector<float> distances = sampson_distances(columns, E);
  std::vector<BearingPair> inliers;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (!(distances[i] < threshold)) continue;
    estimate.inliers[static_cast<std::size_t>(order[i])] = 1;
    inliers.push_back(pairs[static_cast<std::size_t>(order[i])]);
  }
  estimate.inlier_count = static_cast<int>(inliers.size());
  estimate.residual = sigma;
  estimate.pose = pose_in_front(E, inliers, 3 * sigma);
  estimate.covariance = pose_covariance(columns, estimate.pose, cutoff);
  estimate.model = ViewModel::general;
  return estimate;
}

}  // namespace stillkite
