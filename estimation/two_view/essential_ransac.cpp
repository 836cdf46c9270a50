#include "estimation/two_view/essential_ransac.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/two_view/essential_decomposition.hpp"
#include "estimation/two_view/five_point.hpp"
#include "estimation/two_view/random_draws.hpp"
#include "estimation/two_view/sampson_refinement.hpp"

namespace stillkite {
namespace {

// Tukey cutoffs in thresholds. The first covers the error of the initial model: five noisy pairs,
// or a prior with an error of a few degrees. A narrow cutoff has local minima, where a few outliers
// outweigh the parallax of the relief, so each cutoff is iterated to convergence. A wide cutoff
// moves a pose without error towards objects that move on their own.
constexpr std::array<double, 3> kSampleCutoffs{4, 2, 1.5};
constexpr std::array<double, 5> kInitialPoseCutoffs{20, 10, 5, 2.5, 1.5};
constexpr std::array<double, 1> kFinalCutoff{1.5};
constexpr int kStepsPerCutoff = 6;

int count_below(const std::vector<float>& distances, double from, double to) {
  return static_cast<int>(std::count_if(distances.begin(), distances.end(),
                                        [&](float e) { return e >= from && e < to; }));
}

EssentialFit refine(const BearingColumns& columns, RelativePose pose, double threshold,
                    std::span<const double> cutoffs) {
  for (const double cutoff : cutoffs) {
    pose = refine_pose(columns, pose, cutoff * threshold, kStepsPerCutoff);
  }
  EssentialFit fit{.pose = pose, .found = true};
  const Eigen::Matrix3d E = essential_matrix(pose);
  fit.cost = truncated_cost(columns, E, threshold, static_cast<double>(columns.size()));
  fit.inliers = count_below(sampson_distances(columns, E), 0, threshold);
  return fit;
}

double draws_needed(double inlier_ratio, double confidence) {
  const double all_inliers = std::pow(inlier_ratio, 5);
  if (all_inliers >= 1) return 0;
  return std::log(1 - confidence) / std::log1p(-std::max(all_inliers, 1e-12));
}

std::array<BearingPair, 5> pairs_at(const BearingColumns& c,
                                    const std::array<std::size_t, 5>& indices) {
  std::array<BearingPair, 5> pairs;
  for (std::size_t k = 0; k < 5; ++k) {
    const std::size_t i = indices[k];
    pairs[k] = {{c.ax[i], c.ay[i]}, {c.bx[i], c.by[i]}};
  }
  return pairs;
}

}  // namespace

bool is_supported(const BearingColumns& columns, const Eigen::Matrix3d& E, double threshold) {
  const std::vector<float> distances = sampson_distances(columns, E);
  const int inliers = count_below(distances, 0, threshold);
  const int margin_pairs = count_below(distances, threshold, 3 * threshold);
  const int background_pairs = count_below(distances, 3 * threshold, 5 * threshold);
  return inliers >= 0.25 * static_cast<double>(columns.size()) &&
         margin_pairs <= background_pairs + 2 * std::sqrt(background_pairs + 1.0) + 0.1 * inliers;
}

EssentialFit refine_initial_pose(const BearingColumns& columns, const RelativePose& initial,
                                 double threshold) {
  const EssentialFit graduated = refine(columns, initial, threshold, kInitialPoseCutoffs);
  const EssentialFit direct = refine(columns, initial, threshold, kFinalCutoff);
  return direct.cost < graduated.cost ? direct : graduated;
}

EssentialFit fit_essential(const BearingColumns& columns, double threshold,
                           const RelativePoseConfig& config,
                           std::span<const RelativePose> initial_poses) {
  EssentialFit best{.cost = static_cast<double>(columns.size())};
  if (columns.size() < 5) return best;
  for (const RelativePose& initial : initial_poses) {
    const EssentialFit fit = refine_initial_pose(columns, initial, threshold);
    if (fit.cost < best.cost) best = fit;
    if (is_supported(columns, essential_matrix(fit.pose), threshold)) return best;
  }
  RandomDraws random(static_cast<std::uint64_t>(config.seed) + 1);
  const auto count = static_cast<double>(columns.size());
  // one sample in 2000 has five inliers: probability 99.9 % at an inlier ratio of 0.32
  constexpr double kMaxSamples = 2000;
  double needed = kMaxSamples;
  for (int draws = 0; draws < needed; ++draws) {
    const std::array<BearingPair, 5> sample = pairs_at(columns, random.distinct<5>(columns.size()));
    const EssentialCandidates candidates = solve_five_point(sample);
    for (int k = 0; k < candidates.count; ++k) {
      const Eigen::Matrix3d& E = candidates.essential[static_cast<std::size_t>(k)];
      const double cost = truncated_cost(columns, E, threshold, best.cost);
      if (cost >= best.cost) continue;
      const EssentialFit fit =
          refine(columns, decompose_essential(E)[0], threshold, kSampleCutoffs);
      if (fit.cost < best.cost) best = fit;
      needed = std::min(needed, draws_needed(best.inliers / count, config.confidence));
    }
  }
  return best;
}

}  // namespace stillkite
