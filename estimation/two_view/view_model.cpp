#include "estimation/two_view/view_model.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/two_view/transfer_error.hpp"
#include "geometry/angle.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

// Of min(x, 6), x chi-square with two degrees of freedom: 2 (1 - e^-3), and the standard deviation.
constexpr double kCut = 6;
constexpr double kMeanOfCut = 1.9004259;
constexpr double kSigmaOfCut = 1.672;
// Chi-square with three and five degrees of freedom, quantile 1 - 3e-7 (five sigma).
constexpr double kThreeMore = 33;
constexpr double kFiveMore = 38;

double mean_of_cut(const BearingColumns& inliers, const Eigen::Matrix3d& H, double sigma) {
  double sum = 0;
  for (const float d : transfer_distances(inliers, H)) {
    sum += std::min(d * d / (sigma * sigma), kCut);
  }
  return inliers.size() > 0 ? sum / static_cast<double>(inliers.size()) : kCut;
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return angle_between_rad(a, b) / kDegree;
}

struct FacingView {
  PlaneMotion view;
  double part_ahead = 0;  // of the pairs, in front of the plane's camera
};

// Towards the plane from the reference camera, as most pairs see it.
FacingView facing_pairs(PlaneMotion view, const BearingColumns& inliers) {
  int ahead = 0;
  const auto count = static_cast<int>(inliers.size());
  for (std::size_t i = 0; i < inliers.size(); ++i) {
    ahead += view.normal.dot(Eigen::Vector3d(inliers.ax[i], inliers.ay[i], 1)) > 0 ? 1 : 0;
  }
  if (2 * ahead < count) {
    view.normal = -view.normal;
    view.translation = -view.translation;
    ahead = count - ahead;
  }
  return {view, count > 0 ? static_cast<double>(ahead) / count : 0};
}

// The index of the smaller, where it is smaller by the margin.
std::optional<std::size_t> clearly_smaller(double first, double second, double margin) {
  if (first + margin < second) return 0;
  if (second + margin < first) return 1;
  return std::nullopt;
}

using Choice = std::optional<std::size_t>;
using TwoViews = std::array<PlaneMotion, 2>;

std::array<double, 2> of_both(const TwoViews& views, const auto& measure) {
  return {measure(views[0]), measure(views[1])};
}

Choice by_vertical(const TwoViews& views, const RelativePoseHints& hints, double sigma_deg) {
  if (!hints.up_in_reference || !hints.up_in_current) return std::nullopt;
  const auto [a, b] = of_both(views, [&](const PlaneMotion& view) {
    return angle_deg(view.rotation * *hints.up_in_reference, *hints.up_in_current);
  });
  return clearly_smaller(a, b, 3 * sigma_deg);
}

Choice by_level(const TwoViews& views, const RelativePoseHints& hints) {
  constexpr double kLevel_deg = 10;
  if (!hints.up_in_reference) return std::nullopt;
  const auto [a, b] = of_both(views, [&](const PlaneMotion& view) {
    const double angle = angle_deg(view.normal, *hints.up_in_reference);
    return std::min(angle, 180 - angle);
  });
  if (std::min(a, b) >= kLevel_deg) return std::nullopt;
  return clearly_smaller(a, b, 0.5 * kLevel_deg);
}

Choice by_prior(const TwoViews& views, const RelativePoseHints& hints) {
  constexpr double kRotation_deg = 2.5;
  constexpr double kDirection_deg = 25;
  if (!hints.prior) return std::nullopt;
  const auto [a, b] = of_both(views, [&](const PlaneMotion& view) {
    return angle_between_rad(view.rotation, hints.prior->current_from_reference) / kDegree;
  });
  if (const Choice k = clearly_smaller(a, b, kRotation_deg)) return k;
  const auto [c, d] = of_both(views, [&](const PlaneMotion& view) {
    return angle_deg(view.translation, hints.prior->direction);
  });
  if (std::min(c, d) >= kDirection_deg) return std::nullopt;
  return clearly_smaller(c, d, kDirection_deg);
}

// The vertical, unless level ground and the prior are against it: carried on by the flow it is off
// by degrees where much of the image moves otherwise.
Choice by_ground(const TwoViews& views, const RelativePoseHints& hints,
                 const RelativePoseConfig& config) {
  const Choice vertical = by_vertical(views, hints, config.vertical_sigma_deg);
  const Choice level = by_level(views, hints);
  if (level && level == by_prior(views, hints)) return level;
  return vertical ? vertical : level;
}

}  // namespace

ModelEvidence weigh_models(const BearingColumns& inliers, const Eigen::Quaterniond& rotation,
                           const Eigen::Matrix3d& plane, double sigma, double floor) {
  const double noise = std::hypot(sigma, floor);
  return {.still = mean_of_cut(inliers, Eigen::Matrix3d::Identity(), noise),
          .rotation = mean_of_cut(inliers, rotation.toRotationMatrix(), noise),
          .plane = mean_of_cut(inliers, plane, noise),
          .pairs = static_cast<double>(inliers.size()),
          .floor = floor * floor / (noise * noise)};
}

ViewModel simplest_model(const ModelEvidence& e) {
  // a mean that pairs which lie on their epipolar lines by chance may raise, but not noise
  const double worst = kMeanOfCut + std::max(0.3, 6 * kSigmaOfCut / std::sqrt(e.pairs));
  const auto stands = [&](double mean) { return mean < worst; };
  // a larger model is worth its parameters only if it explains more than chance and the floor
  const auto better = [&](double larger, double smaller, double chance) {
    return e.pairs * (smaller - larger) > chance + e.pairs * e.floor;
  };
  if (stands(e.still) && !better(e.rotation, e.still, kThreeMore) &&
      !better(e.plane, e.still, kThreeMore + kFiveMore)) {
    return ViewModel::still;
  }
  if (stands(e.rotation) && !better(e.plane, e.rotation, kFiveMore)) {
    return ViewModel::rotation_only;
  }
  return stands(e.plane) ? ViewModel::plane : ViewModel::general;
}

std::optional<PlaneMotion> resolve_plane(const std::array<PlaneMotion, 2>& views,
                                         const BearingColumns& on_plane,
                                         const RelativePoseHints& hints,
                                         const RelativePoseConfig& config) {
  constexpr double kMostAhead = 0.9;
  const FacingView a = facing_pairs(views[0], on_plane), b = facing_pairs(views[1], on_plane);
  const TwoViews turned{a.view, b.view};
  const bool first = a.part_ahead > kMostAhead, second = b.part_ahead > kMostAhead;
  if (first != second) return turned[first ? 0 : 1];
  if (!first) return std::nullopt;
  const double turn_deg = angle_between_rad(turned[0].rotation, turned[1].rotation) / kDegree;
  // along the normal both are the same motion, which noise splits
  if (turn_deg < 0.1 && angle_deg(turned[0].translation, turned[1].translation) < 5) {
    return turned[0];
  }
  Choice k = by_ground(turned, hints, config);
  if (!k) k = by_prior(turned, hints);
  return k ? std::optional(turned[*k]) : std::nullopt;
}

std::optional<std::size_t> view_over_ground(const std::array<PlaneMotion, 2>& views,
                                            const BearingColumns& inliers,
                                            const RelativePoseHints& hints,
                                            const RelativePoseConfig& config) {
  return by_ground({facing_pairs(views[0], inliers).view, facing_pairs(views[1], inliers).view},
                   hints, config);
}

}  // namespace stillkite
