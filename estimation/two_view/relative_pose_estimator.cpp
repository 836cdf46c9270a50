#include "estimation/two_view/relative_pose_estimator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "estimation/residual_scale.hpp"
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

// Of two components: their median length is sqrt(2 ln 2) standard deviations; Tukey's cutoff for 95
// % of the efficiency is as in robust_kernel.hpp.
constexpr double kSigmaOfMedianLength = 1 / kRayleighMedian;
constexpr double kTukeyCutoffOfLength = 5.1;
constexpr double kLeastCutoff = 1e-9;
constexpr double kCutoffInThresholds = 1.5;
constexpr int kRotationDraws = 40;
constexpr int kPlaneDraws = 15;

// The pairs of one call and what is found out about them on the way.
struct Problem {
  std::span<const BearingPair> pairs;
  const RelativePoseConfig& config;
  const RelativePoseHints& hints;
  double threshold;
  std::vector<int> order;  // of the columns' pairs
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

// A pose and the cutoff of Tukey's weights that it was refined with.
template <typename Pose>
struct Refined {
  Pose pose;
  double cutoff;
};

// Refines with a cutoff that shrinks with the noise which the pose leaves: `refine(pose, cutoff)`,
// `distances(pose)`.
template <typename Pose>
Refined<Pose> refine_to_noise(const Problem& problem, Pose pose, double sigma_of_median,
                              double cutoff_in_sigma, const auto& refine, const auto& distances) {
  const double widest = kCutoffInThresholds * problem.threshold;
  if (!problem.config.refine) return {pose, widest};
  double cutoff = widest;
  // from wide to narrow: a narrow cutoff alone has false minima
  for (const double wide : {4.0, 2.0}) pose = refine(pose, wide * widest);
  double sigma = scale_below(distances(pose), problem.threshold, sigma_of_median);
  for (int i = 0; i < 10; ++i) {
    cutoff = std::clamp(cutoff_in_sigma * sigma, kLeastCutoff, widest);
    pose = refine(pose, cutoff);
    const double before = sigma;
    sigma = scale_below(distances(pose), problem.threshold, sigma_of_median);
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
  estimate.residual = scale_below(distances, problem.threshold, sigma_of_median);
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
  RelativePoseEstimate estimate =
      with_inliers(problem, ViewModel::general, distances, kSigmaOfMedian);
  estimate.pose = pose_in_front(E, inlier_columns(problem, distances), 3 * estimate.residual);
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
      problem, rotation, kSigmaOfMedianLength, kTukeyCutoffOfLength,
      [&](const Eigen::Quaterniond& q, double cutoff) {
        return refine_rotation(problem.columns, q, cutoff, 4);
      },
      distances);
  RelativePoseEstimate estimate =
      with_inliers(problem, model, distances(fit.pose), kSigmaOfMedianLength);
  estimate.pose.current_from_reference = fit.pose;
  estimate.epipolar = epipolar;
  estimate.covariance = rotation_covariance(problem.columns, fit.pose, fit.cutoff);
  return estimate;
}

RelativePoseEstimate plane_estimate(const Problem& problem, const Eigen::Matrix3d& rough,
                                    const RelativePose& epipolar) {
  const auto distances = [&](const Eigen::Matrix3d& H) {
    return transfer_distances(problem.columns, H);
  };
  const Refined<Eigen::Matrix3d> fit = refine_to_noise(
      problem, rough, kSigmaOfMedianLength, kTukeyCutoffOfLength,
      [&](const Eigen::Matrix3d& H, double cutoff) {
        return refine_homography(problem.columns, H, cutoff, 4);
      },
      distances);
  // of what stands behind the plane, as over the horizon, nothing need be in front of it
  const BearingColumns on_plane = inlier_columns(problem, distances(fit.pose));
  const std::optional<PlaneMotion> view =
      resolve_plane(decompose_homography(fit.pose), on_plane, problem.hints, problem.config);
  RelativePoseEstimate estimate =
      with_inliers(problem, view ? ViewModel::plane : ViewModel::undecided, distances(fit.pose),
                   kSigmaOfMedianLength);
  estimate.epipolar = epipolar;
  if (!view) return estimate;
  estimate.pose = {view->rotation, view->translation.normalized()};
  estimate.covariance = plane_covariance(problem.columns, *view, fit.cutoff);
  return estimate;
}

// A scene that is nearly flat has a second minimum near the plane's other pose. What a lens is off
// by may make the false one the better of both: which of them keeps the vertical, or the ground
// level, says more, unless it explains far less.
EssentialFit beside_plane(const Problem& problem, const EssentialFit& fit,
                          const Eigen::Matrix3d& plane, const BearingColumns& inliers) {
  constexpr double kFarWorse = 3;
  const std::array<PlaneMotion, 2> views = decompose_homography(plane);
  const std::optional<std::size_t> known =
      view_over_ground(views, inliers, problem.hints, problem.config);
  EssentialFit best = fit;
  std::optional<EssentialFit> of_known;
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (!(views[k].translation.norm() > 0)) continue;
    const EssentialFit other = optimise_start(
        problem.columns, {views[k].rotation, views[k].translation.normalized()}, problem.threshold);
    if (other.cost < best.cost) best = other;
    if (known == k) of_known = other;
  }
  return of_known && of_known->cost < kFarWorse * best.cost ? *of_known : best;
}

// On weights of bounded leverage, which a better pose may shift.
Refined<RelativePose> refine_essential(const Problem& problem, const EssentialFit& fit) {
  Refined<RelativePose> refined{fit.pose, kCutoffInThresholds * problem.threshold};
  for (int round = 0; problem.config.refine && round < 2; ++round) {
    const BearingColumns columns =
        with_bounded_leverage(problem.columns, refined.pose, refined.cutoff);
    refined = refine_to_noise(
        problem, refined.pose, kSigmaOfMedian, kTukeyCutoff,
        [&](const RelativePose& pose, double cutoff) {
          return refine_pose(columns, pose, cutoff, 8);
        },
        [&](const RelativePose& pose) {
          return sampson_distances(columns, essential_matrix(pose));
        });
  }
  return refined;
}

// Where the estimate may start from: the prior, and the rotation that explains at least a quarter
// of the pairs with the direction in which they are displaced beside it.
std::vector<RelativePose> starts_of(const Problem& problem, const Eigen::Quaterniond& rotation) {
  std::vector<RelativePose> starts;
  const std::optional<RelativePose>& prior = problem.hints.prior;
  if (problem.config.use_prior && prior && prior->direction.norm() > 0.5) {
    starts.push_back({prior->current_from_reference, prior->direction.normalized()});
  }
  if (!problem.config.model_test) return starts;
  const Eigen::Matrix3d R = rotation.toRotationMatrix();
  const auto count = static_cast<double>(problem.columns.size());
  const double wide = 4 * problem.threshold;
  if (truncated_transfer_cost(problem.columns, R, wide, count) < 0.75 * count) {
    starts.push_back({rotation, direction_beside(problem.columns, rotation, wide)});
  }
  return starts;
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

  // 1. the rotation that explains most pairs, where nothing or little but a rotation is seen
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  if (config.model_test) {
    rotation = fit_rotation(problem.columns, problem.threshold, kRotationDraws, random);
  }

  // 2. the essential matrix: from what is known, else from draws of five pairs
  EssentialFit fit =
      fit_essential(problem.columns, problem.threshold, config, starts_of(problem, rotation));
  if (!fit.found || fit.inliers < config.min_pairs) {
    return with_inliers(problem, ViewModel::undecided, {}, kSigmaOfMedian);
  }
  const Refined<RelativePose> refined = refine_essential(problem, fit);
  if (!config.model_test) return general_estimate(problem, refined);

  // 3. is a simpler model enough for its inliers?
  const std::vector<float> distances =
      sampson_distances(problem.columns, essential_matrix(refined.pose));
  const BearingColumns inliers = inlier_columns(problem, distances);
  if (inliers.size() < static_cast<std::size_t>(config.min_pairs)) {
    return with_inliers(problem, ViewModel::undecided, {}, kSigmaOfMedian);
  }
  const Eigen::Matrix3d plane = fit_homography(inliers, problem.threshold, kPlaneDraws, random);
  const ModelEvidence evidence = weigh_models(
      inliers, refine_rotation(inliers, rotation, 2 * problem.threshold, 3), plane,
      scale_below(distances, problem.threshold, kSigmaOfMedian), config.model_floor_px / focal_px);
  switch (const ViewModel model = simplest_model(evidence); model) {
    case ViewModel::still:
    case ViewModel::rotation_only:
      return rotation_estimate(problem, model, rotation, refined.pose);
    case ViewModel::plane:
      return plane_estimate(problem, plane, refined.pose);
    default:
      break;
  }

  // 4. depth it is: the pose of the essential matrix
  const double outside = truncated_transfer_cost(inliers, plane, 4 * problem.threshold,
                                                 static_cast<double>(inliers.size()));
  if (outside > 0.5 * static_cast<double>(inliers.size())) {
    return general_estimate(problem, refined);
  }
  return general_estimate(problem,
                          refine_essential(problem, beside_plane(problem, fit, plane, inliers)));
}

}  // namespace stillkite
