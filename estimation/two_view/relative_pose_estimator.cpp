#include "estimation/two_view/relative_pose_estimator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "estimation/robust_kernel.hpp"
#include "estimation/two_view/essential_decomposition.hpp"
#include "estimation/two_view/essential_ransac.hpp"
#include "estimation/two_view/leverage.hpp"
#include "estimation/two_view/random_draws.hpp"
#include "estimation/two_view/rotation_view.hpp"
#include "estimation/two_view/sampson_refinement.hpp"
#include "estimation/two_view/transfer_error.hpp"
#include "estimation/two_view/view_model.hpp"

namespace stillkite {
namespace {

// Two components: median length sqrt(2 ln 2) standard deviations; Tukey cutoff for 95 % efficiency
// as in robust_kernel.hpp.
constexpr double kMedianLengthToSigma = 1 / kRayleighMedian;
constexpr double kTukeyCutoff2d = 5.1;
constexpr double kMinCutoff = 1e-9;
constexpr double kCutoffInThresholds = 1.5;
constexpr int kRotationDraws = 40;
constexpr int kPlaneDraws = 15;
// Five pairs determine the pose; seven more determine the noise.
constexpr int kMinInliers = 12;

// Inputs of one call.
struct Problem {
  std::span<const BearingPair> pairs;
  const RelativePoseConfig& config;
  const RelativePoseHints& hints;
  double threshold;
  std::vector<int> order;  // pair index of each column entry
  BearingColumns columns;
};

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

// Pose with the Tukey cutoff of its refinement.
template <typename Pose>
struct Refined {
  Pose pose;
  double cutoff;
};

// Refines with a cutoff that follows the estimated noise: `refine(pose, cutoff)`,
// `distances(pose)`.
template <typename Pose>
Refined<Pose> refine_to_noise(const Problem& problem, Pose pose, double sigma_of_median,
                              double cutoff_in_sigma, const auto& refine, const auto& distances) {
  const double max_cutoff = kCutoffInThresholds * problem.threshold;
  double cutoff = max_cutoff;
  double sigma = inlier_scale(distances(pose), problem.threshold, sigma_of_median);
  for (int i = 0; i < 10; ++i) {
    cutoff = std::clamp(cutoff_in_sigma * sigma, kMinCutoff, max_cutoff);
    pose = refine(pose, cutoff);
    const double before = sigma;
    sigma = inlier_scale(distances(pose), problem.threshold, sigma_of_median);
    if (sigma > 0.98 * before) break;
  }
  return {pose, cutoff};
}

RelativePoseEstimate with_inliers(const Problem& problem, ViewModel model,
                                  const std::vector<float>& distances, double sigma_of_median) {
  RelativePoseEstimate estimate{.model = model};
  estimate.inliers.assign(problem.pairs.size(), 0);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const bool inlier = distances[i] < problem.threshold;
    estimate.inliers[static_cast<std::size_t>(problem.order[i])] = inlier ? 1 : 0;
    estimate.inlier_count += inlier ? 1 : 0;
  }
  estimate.residual = inlier_scale(distances, problem.threshold, sigma_of_median);
  return estimate;
}

BearingColumns inlier_columns(const Problem& problem, const std::vector<float>& distances) {
  std::vector<int> order;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (distances[i] < problem.threshold) order.push_back(problem.order[i]);
  }
  return {problem.pairs, order};
}

RelativePoseEstimate general_estimate(const Problem& problem, const Refined<RelativePose>& fit) {
  const Eigen::Matrix3d E = essential_matrix(fit.pose);
  const std::vector<float> distances = sampson_distances(problem.columns, E);
  RelativePoseEstimate estimate = with_inliers(problem, ViewModel::general, distances, kMadToSigma);
  estimate.pose =
      select_by_cheirality(E, inlier_columns(problem, distances), 3 * estimate.residual);
  estimate.epipolar = estimate.pose;
  estimate.covariance = pose_covariance(
      with_bounded_leverage(problem.columns, estimate.pose, fit.cutoff), estimate.pose, fit.cutoff);
  return estimate;
}

RelativePoseEstimate rotation_estimate(const Problem& problem, ViewModel model,
                                       const Eigen::Quaterniond& rotation,
                                       const RelativePose& epipolar) {
  const auto distances = [&](const Eigen::Quaterniond& q) {
    return transfer_distances(problem.columns, q.toRotationMatrix());
  };
  const Refined<Eigen::Quaterniond> fit = refine_to_noise(
      problem, rotation, kMedianLengthToSigma, kTukeyCutoff2d,
      [&](const Eigen::Quaterniond& q, double cutoff) {
        return refine_rotation(problem.columns, q, cutoff, 4);
      },
      distances);
  RelativePoseEstimate estimate =
      with_inliers(problem, model, distances(fit.pose), kMedianLengthToSigma);
  estimate.pose.current_from_reference = fit.pose;
  estimate.epipolar = epipolar;
  estimate.covariance = rotation_covariance(problem.columns, fit.pose, fit.cutoff);
  return estimate;
}

RelativePoseEstimate plane_estimate(const Problem& problem, const Eigen::Matrix3d& initial,
                                    const RelativePose& epipolar) {
  const auto distances = [&](const Eigen::Matrix3d& H) {
    return transfer_distances(problem.columns, H);
  };
  const Refined<Eigen::Matrix3d> fit = refine_to_noise(
      problem, initial, kMedianLengthToSigma, kTukeyCutoff2d,
      [&](const Eigen::Matrix3d& H, double cutoff) {
        return refine_homography(problem.columns, H, cutoff, 4);
      },
      distances);
  // cheirality holds for inliers of the plane only; points beyond the horizon lie behind it
  const BearingColumns on_plane = inlier_columns(problem, distances(fit.pose));
  const std::optional<PlaneMotion> motion =
      resolve_plane(decompose_homography(fit.pose), on_plane, problem.hints, problem.config);
  RelativePoseEstimate estimate =
      with_inliers(problem, motion ? ViewModel::plane : ViewModel::undecided, distances(fit.pose),
                   kMedianLengthToSigma);
  estimate.epipolar = epipolar;
  if (!motion) return estimate;
  estimate.pose = {motion->rotation, motion->translation.normalized()};
  estimate.covariance = plane_covariance(problem.columns, *motion, fit.cutoff);
  return estimate;
}

// A nearly flat scene has a second minimum near the plane's other pose. Lens distortion errors can
// give the wrong minimum the lower cost. Prefers the pose with a consistent vertical or a level
// plane unless its cost exceeds `kMaxCostRatio` times the lowest.
EssentialFit fit_near_plane(const Problem& problem, const EssentialFit& fit,
                            const Eigen::Matrix3d& plane, const BearingColumns& inliers) {
  constexpr double kMaxCostRatio = 3;
  const std::array<PlaneMotion, 2> motions = decompose_homography(plane);
  const std::optional<std::size_t> preferred =
      select_over_ground(motions, inliers, problem.hints, problem.config);
  EssentialFit best = fit;
  std::optional<EssentialFit> preferred_fit;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    if (!(motions[k].translation.norm() > 0)) continue;
    const EssentialFit candidate = refine_initial_pose(
        problem.columns, {motions[k].rotation, motions[k].translation.normalized()},
        problem.threshold);
    if (candidate.cost < best.cost) best = candidate;
    if (preferred == k) preferred_fit = candidate;
  }
  return preferred_fit && preferred_fit->cost < kMaxCostRatio * best.cost ? *preferred_fit : best;
}

// Two rounds: the leverage weights depend on the pose.
Refined<RelativePose> refine_essential(const Problem& problem, const EssentialFit& fit) {
  Refined<RelativePose> refined{fit.pose, kCutoffInThresholds * problem.threshold};
  for (int round = 0; round < 2; ++round) {
    const BearingColumns columns =
        with_bounded_leverage(problem.columns, refined.pose, refined.cutoff);
    refined = refine_to_noise(
        problem, refined.pose, kMadToSigma, kTukeyCutoff,
        [&](const RelativePose& pose, double cutoff) {
          return refine_pose(columns, pose, cutoff, 8);
        },
        [&](const RelativePose& pose) {
          return sampson_distances(columns, essential_matrix(pose));
        });
  }
  return refined;
}

// Initial poses: the prior; the rotation with the direction of the residual displacements, if its
// MSAC cost is below 75 % of the maximum.
std::vector<RelativePose> initial_poses(const Problem& problem,
                                        const Eigen::Quaterniond& rotation) {
  std::vector<RelativePose> poses;
  const std::optional<RelativePose>& prior = problem.hints.prior;
  if (prior && prior->direction.norm() > 0.5) {
    poses.push_back({prior->current_from_reference, prior->direction.normalized()});
  }
  if (!problem.config.model_test) return poses;
  const Eigen::Matrix3d R = rotation.toRotationMatrix();
  const auto count = static_cast<double>(problem.columns.size());
  const double wide = 4 * problem.threshold;
  if (truncated_transfer_cost(problem.columns, R, wide, count) < 0.75 * count) {
    poses.push_back({rotation, displacement_direction(problem.columns, rotation, wide)});
  }
  return poses;
}

}  // namespace

RelativePoseEstimate estimate_relative_pose(std::span<const BearingPair> pairs, double focal_px,
                                            const RelativePoseConfig& config,
                                            const RelativePoseHints& hints) {
  const std::vector<int> order = shuffled_finite_pairs(pairs, config.seed);
  const Problem problem{.pairs = pairs,
                        .config = config,
                        .hints = hints,
                        .threshold = config.threshold_px / focal_px,
                        .order = order,
                        .columns = {pairs, order}};
  RandomDraws random(static_cast<std::uint64_t>(config.seed));

  // 1. dominant rotation
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  if (config.model_test) {
    rotation = fit_rotation(problem.columns, problem.threshold, kRotationDraws, random);
  }

  // 2. essential matrix: from the initial poses, else RANSAC on five pairs
  EssentialFit fit =
      fit_essential(problem.columns, problem.threshold, config, initial_poses(problem, rotation));
  if (!fit.found || fit.inliers < kMinInliers) {
    return with_inliers(problem, ViewModel::undecided, {}, kMadToSigma);
  }
  const Refined<RelativePose> refined = refine_essential(problem, fit);
  if (!config.model_test) return general_estimate(problem, refined);

  // 3. model selection on its inliers
  const std::vector<float> distances =
      sampson_distances(problem.columns, essential_matrix(refined.pose));
  const BearingColumns inliers = inlier_columns(problem, distances);
  if (inliers.size() < kMinInliers) {
    return with_inliers(problem, ViewModel::undecided, {}, kMadToSigma);
  }
  const Eigen::Matrix3d plane = fit_homography(inliers, problem.threshold, kPlaneDraws, random);
  const ModelEvidence evidence = evaluate_models(
      inliers, refine_rotation(inliers, rotation, 2 * problem.threshold, 3), plane,
      inlier_scale(distances, problem.threshold, kMadToSigma), config.model_floor_px / focal_px);
  switch (const ViewModel model = simplest_model(evidence); model) {
    case ViewModel::still:
    case ViewModel::rotation_only:
      return rotation_estimate(problem, model, rotation, refined.pose);
    case ViewModel::plane:
      return plane_estimate(problem, plane, refined.pose);
    default:
      break;
  }

  // 4. general scene: pose of the essential matrix
  const double off_plane_cost = truncated_transfer_cost(inliers, plane, 4 * problem.threshold,
                                                        static_cast<double>(inliers.size()));
  if (off_plane_cost > 0.5 * static_cast<double>(inliers.size())) {
    return general_estimate(problem, refined);
  }
  return general_estimate(problem,
                          refine_essential(problem, fit_near_plane(problem, fit, plane, inliers)));
}

}  // namespace stillkite
