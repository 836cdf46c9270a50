#include "estimation/two_view/view_model.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/two_view/transfer_error.hpp"
#include "geometry/angle.hpp"
#include "geometry/chi_square.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

// Mean 2 (1 - e^-3) and standard deviation of min(x, 6), x chi-square with two degrees of freedom.
constexpr double kTruncation = 6;
constexpr double kTruncatedMean = 1.9004259;
constexpr double kTruncatedSigma = 1.672;

double truncated_mean(const BearingColumns& inliers, const Eigen::Matrix3d& H, double sigma) {
  double sum = 0;
  for (const float d : transfer_distances(inliers, H)) {
    sum += std::min(d * d / (sigma * sigma), kTruncation);
  }
  return inliers.size() > 0 ? sum / static_cast<double>(inliers.size()) : kTruncation;
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return angle_between_rad(a, b) / kDegree;
}

struct OrientedMotion {
  PlaneMotion motion;
  double ratio_in_front = 0;  // share of the pairs in front of the reference camera
};

// Sign of the normal such that most pairs are in front of the reference camera.
OrientedMotion orient_to_pairs(PlaneMotion motion, const BearingColumns& inliers) {
  int in_front = 0;
  const auto count = static_cast<int>(inliers.size());
  for (std::size_t i = 0; i < inliers.size(); ++i) {
    in_front += motion.normal.dot(Eigen::Vector3d(inliers.ax[i], inliers.ay[i], 1)) > 0 ? 1 : 0;
  }
  if (2 * in_front < count) {
    motion.normal = -motion.normal;
    motion.translation = -motion.translation;
    in_front = count - in_front;
  }
  return {motion, count > 0 ? static_cast<double>(in_front) / count : 0};
}

// Index of the smaller value if the difference exceeds the margin.
std::optional<std::size_t> clearly_smaller(double first, double second, double margin) {
  if (first + margin < second) return 0;
  if (second + margin < first) return 1;
  return std::nullopt;
}

using Choice = std::optional<std::size_t>;
using Hypotheses = std::array<PlaneMotion, 2>;

std::array<double, 2> evaluate_both(const Hypotheses& hypotheses, const auto& measure) {
  return {measure(hypotheses[0]), measure(hypotheses[1])};
}

Choice select_by_vertical(const Hypotheses& hypotheses, const RelativePoseHints& hints,
                          double sigma_deg) {
  if (!hints.up_in_reference || !hints.up_in_current) return std::nullopt;
  const auto [a, b] = evaluate_both(hypotheses, [&](const PlaneMotion& motion) {
    return angle_deg(motion.rotation * *hints.up_in_reference, *hints.up_in_current);
  });
  return clearly_smaller(a, b, 3 * sigma_deg);
}

Choice select_by_level(const Hypotheses& hypotheses, const RelativePoseHints& hints) {
  constexpr double kMaxPlaneTilt_deg = 10;
  if (!hints.up_in_reference) return std::nullopt;
  const auto [a, b] = evaluate_both(hypotheses, [&](const PlaneMotion& motion) {
    const double angle = angle_deg(motion.normal, *hints.up_in_reference);
    return std::min(angle, 180 - angle);
  });
  if (std::min(a, b) >= kMaxPlaneTilt_deg) return std::nullopt;
  return clearly_smaller(a, b, 0.5 * kMaxPlaneTilt_deg);
}

Choice select_by_prior(const Hypotheses& hypotheses, const RelativePoseHints& hints) {
  constexpr double kMinRotationMargin_deg = 2.5;
  constexpr double kMaxDirectionError_deg = 25;
  if (!hints.prior) return std::nullopt;
  const auto [a, b] = evaluate_both(hypotheses, [&](const PlaneMotion& motion) {
    return angle_between_rad(motion.rotation, hints.prior->current_from_reference) / kDegree;
  });
  if (const Choice k = clearly_smaller(a, b, kMinRotationMargin_deg)) return k;
  const auto [c, d] = evaluate_both(hypotheses, [&](const PlaneMotion& motion) {
    return angle_deg(motion.translation, hints.prior->direction);
  });
  if (std::min(c, d) >= kMaxDirectionError_deg) return std::nullopt;
  return clearly_smaller(c, d, kMaxDirectionError_deg);
}

// Vertical, unless level plane and prior agree on the other motion. A vertical propagated by
// optical flow has errors of degrees if much of the image moves independently.
Choice select_by_ground(const Hypotheses& hypotheses, const RelativePoseHints& hints,
                        const RelativePoseConfig& config) {
  const Choice vertical = select_by_vertical(hypotheses, hints, config.vertical_sigma_deg);
  const Choice level = select_by_level(hypotheses, hints);
  if (level && level == select_by_prior(hypotheses, hints)) return level;
  return vertical ? vertical : level;
}

}  // namespace

ModelEvidence evaluate_models(const BearingColumns& inliers, const Eigen::Quaterniond& rotation,
                              const Eigen::Matrix3d& plane, double sigma, double floor) {
  const double noise = std::hypot(sigma, floor);
  return {.still = truncated_mean(inliers, Eigen::Matrix3d::Identity(), noise),
          .rotation = truncated_mean(inliers, rotation.toRotationMatrix(), noise),
          .plane = truncated_mean(inliers, plane, noise),
          .pairs = static_cast<double>(inliers.size()),
          .floor = floor * floor / (noise * noise)};
}

ViewModel simplest_model(const ModelEvidence& e) {
  // margin for outliers on their epipolar lines by chance
  const double max_mean = kTruncatedMean + std::max(0.3, 6 * kTruncatedSigma / std::sqrt(e.pairs));
  const auto is_accepted = [&](double mean) { return mean < max_mean; };
  // a larger model must reduce the residual by more than chance and the systematic error
  const auto is_significant = [&](double larger, double smaller, double chance) {
    return e.pairs * (smaller - larger) > chance + e.pairs * e.floor;
  };
  if (is_accepted(e.still) && !is_significant(e.rotation, e.still, kChiSquareFiveSigma3) &&
      !is_significant(e.plane, e.still, kChiSquareFiveSigma3 + kChiSquareFiveSigma5)) {
    return ViewModel::still;
  }
  if (is_accepted(e.rotation) && !is_significant(e.plane, e.rotation, kChiSquareFiveSigma5)) {
    return ViewModel::rotation_only;
  }
  return is_accepted(e.plane) ? ViewModel::plane : ViewModel::general;
}

std::optional<PlaneMotion> resolve_plane(const std::array<PlaneMotion, 2>& hypotheses,
                                         const BearingColumns& on_plane,
                                         const RelativePoseHints& hints,
                                         const RelativePoseConfig& config) {
  constexpr double kMinRatioInFront = 0.9;
  const OrientedMotion a = orient_to_pairs(hypotheses[0], on_plane);
  const OrientedMotion b = orient_to_pairs(hypotheses[1], on_plane);
  const Hypotheses oriented{a.motion, b.motion};
  const bool first = a.ratio_in_front > kMinRatioInFront;
  const bool second = b.ratio_in_front > kMinRatioInFront;
  if (first != second) return oriented[first ? 0 : 1];
  if (!first) return std::nullopt;
  const double rotation_difference_deg =
      angle_between_rad(oriented[0].rotation, oriented[1].rotation) / kDegree;
  // translation along the normal: both motions are equal up to noise
  if (rotation_difference_deg < 0.1 &&
      angle_deg(oriented[0].translation, oriented[1].translation) < 5) {
    return oriented[0];
  }
  Choice k = select_by_ground(oriented, hints, config);
  if (!k) k = select_by_prior(oriented, hints);
  return k ? std::optional(oriented[*k]) : std::nullopt;
}

std::optional<std::size_t> select_over_ground(const std::array<PlaneMotion, 2>& hypotheses,
                                              const BearingColumns& inliers,
                                              const RelativePoseHints& hints,
                                              const RelativePoseConfig& config) {
  return select_by_ground({orient_to_pairs(hypotheses[0], inliers).motion,
                           orient_to_pairs(hypotheses[1], inliers).motion},
                          hints, config);
}

}  // namespace stillkite
