#include "evaluation/association.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "geometry/median.hpp"

namespace stillkite {
namespace {

template <typename Stamped>
auto first_not_before(std::span<const Stamped> samples, Timestamp stamp) {
  return std::lower_bound(samples.begin(), samples.end(), stamp,
                          [](const Stamped& sample, Timestamp t) { return sample.stamp < t; });
}

double distance_s(Timestamp a, Timestamp b) {
  return std::abs(seconds_between(a, b));
}

template <typename Stamped>
struct Neighbours {
  const Stamped& before;
  const Stamped& after;
  double ratio = 0;  // of the interval, 0 at `before`
};

// Samples around the stamp; one sample twice at its own stamp and beyond the ends. std::nullopt if
// the nearer one is more than `tolerance_s` away.
template <typename Stamped>
std::optional<Neighbours<Stamped>> neighbours(std::span<const Stamped> samples, Timestamp stamp,
                                              double tolerance_s) {
  const auto after = first_not_before(samples, stamp);
  const bool has_after = after != samples.end();
  const bool has_before = after != samples.begin();
  const bool near_after = has_after && distance_s(after->stamp, stamp) <= tolerance_s;
  const bool near_before = has_before && distance_s(std::prev(after)->stamp, stamp) <= tolerance_s;
  if (!near_after && !near_before) return std::nullopt;
  if (!has_after) return Neighbours<Stamped>{*std::prev(after), *std::prev(after)};
  if (!has_before || after->stamp == stamp) return Neighbours<Stamped>{*after, *after};
  const Stamped& before = *std::prev(after);
  return Neighbours<Stamped>{
      before, *after,
      seconds_between(before.stamp, stamp) / seconds_between(before.stamp, after->stamp)};
}

double median_interval_s(std::span<const StampedPose> poses) {
  if (poses.size() < 2) return 0;
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    intervals_s.push_back(seconds_between(poses[i - 1].stamp, poses[i].stamp));
  }
  return upper_median(intervals_s);
}

// True for estimates that are the nearest one to a row of the truth, at most `max_distance_s` away.
std::vector<bool> nearest_to_a_row(std::span<const StampedPose> estimates,
                                   std::span<const StampedPose> truth, double max_distance_s) {
  std::vector<bool> is_nearest(estimates.size(), false);
  for (const StampedPose& row : truth) {
    auto nearest = first_not_before(estimates, row.stamp);
    if (nearest != estimates.begin() &&
        (nearest == estimates.end() || distance_s(std::prev(nearest)->stamp, row.stamp) <=
                                           distance_s(nearest->stamp, row.stamp))) {
      --nearest;
    }
    if (nearest == estimates.end()) continue;
    if (distance_s(nearest->stamp, row.stamp) > max_distance_s) continue;
    is_nearest[static_cast<std::size_t>(nearest - estimates.begin())] = true;
  }
  return is_nearest;
}

// Pose interpolated between two rows at most `max_interval_s` apart.
std::optional<RigidTransform> pose_between(std::span<const StampedPose> poses, Timestamp stamp,
                                           double max_interval_s) {
  const auto after = first_not_before(poses, stamp);
  if (after == poses.begin() || after == poses.end()) return std::nullopt;
  const StampedPose& before = *std::prev(after);
  const double interval_s = seconds_between(before.stamp, after->stamp);
  if (interval_s > max_interval_s) return std::nullopt;
  return interpolate(before.world_from_body, after->world_from_body,
                     seconds_between(before.stamp, stamp) / interval_s);
}

}  // namespace

std::optional<RigidTransform> pose_at(std::span<const StampedPose> poses, Timestamp stamp,
                                      double tolerance_s) {
  const auto at = neighbours(poses, stamp, tolerance_s);
  if (!at) return std::nullopt;
  if (at->ratio == 0) return at->before.world_from_body;
  return interpolate(at->before.world_from_body, at->after.world_from_body, at->ratio);
}

std::optional<Eigen::Vector3d> velocity_at(std::span<const StampedVelocity> velocities,
                                           Timestamp stamp, double tolerance_s) {
  const auto at = neighbours(velocities, stamp, tolerance_s);
  if (!at) return std::nullopt;
  const Eigen::Vector3d& before = at->before.velocity_in_world_m_s;
  return before + at->ratio * (at->after.velocity_in_world_m_s - before);
}

std::optional<Twist> twist_at(std::span<const StampedTwist> twists, Timestamp stamp,
                              double tolerance_s) {
  auto nearest = first_not_before(twists, stamp);
  if (nearest != twists.begin() &&
      (nearest == twists.end() ||
       distance_s(std::prev(nearest)->stamp, stamp) < distance_s(nearest->stamp, stamp))) {
    --nearest;
  }
  if (nearest == twists.end() || distance_s(nearest->stamp, stamp) > tolerance_s) {
    return std::nullopt;
  }
  return nearest->twist;
}

VelocityAssociation::VelocityAssociation(std::span<const StampedVelocity> velocities,
                                         double tolerance_s)
    : velocities_(velocities), tolerance_s_(tolerance_s) {
  constexpr double kMaxIntervals = 2.5;  // one missing row
  if (velocities.size() < 2) return;
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < velocities.size(); ++i) {
    intervals_s.push_back(seconds_between(velocities[i - 1].stamp, velocities[i].stamp));
  }
  max_interval_s_ = kMaxIntervals * upper_median(intervals_s);
}

std::optional<Eigen::Vector3d> VelocityAssociation::next(Timestamp stamp, double max_distance_s) {
  const auto unused = velocities_.subspan(unused_);
  auto nearest = first_not_before(unused, stamp);
  if (nearest != unused.begin() &&
      (nearest == unused.end() ||
       distance_s(std::prev(nearest)->stamp, stamp) < distance_s(nearest->stamp, stamp))) {
    --nearest;
  }
  if (nearest == unused.end() || distance_s(nearest->stamp, stamp) > max_distance_s) {
    return std::nullopt;
  }
  const std::size_t row = unused_ + static_cast<std::size_t>(nearest - unused.begin());
  const bool is_before = nearest->stamp < stamp;
  const bool has_other = is_before ? row + 1 < velocities_.size() : row > 0;
  const StampedVelocity& a = *nearest;
  const StampedVelocity& b = velocities_[!has_other ? row : is_before ? row + 1 : row - 1];
  const double interval_s = distance_s(a.stamp, b.stamp);
  const bool interpolates = interval_s > 0 && interval_s <= max_interval_s_;
  if (!interpolates && distance_s(a.stamp, stamp) > tolerance_s_) return std::nullopt;
  unused_ = row + 1;
  const double ratio = interpolates ? distance_s(a.stamp, stamp) / interval_s : 0;
  return Eigen::Vector3d(a.velocity_in_world_m_s +
                         ratio * (b.velocity_in_world_m_s - a.velocity_in_world_m_s));
}

std::vector<PosePair> associate(std::span<const StampedPose> estimates,
                                std::span<const StampedPose> truth, double tolerance_s) {
  constexpr double kMaxIntervals = 2.5, kHalf = 0.501;  // one missing row; with rounding
  const double max_interval_s = kMaxIntervals * median_interval_s(truth);
  const std::vector<bool> is_nearest =
      nearest_to_a_row(estimates, truth, kHalf * median_interval_s(estimates));
  std::vector<PosePair> pairs;
  pairs.reserve(estimates.size());
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const Timestamp stamp = estimates[i].stamp;
    std::optional<RigidTransform> pose = pose_at(truth, stamp, tolerance_s);
    if (!pose && is_nearest[i]) pose = pose_between(truth, stamp, max_interval_s);
    if (!pose) continue;
    pairs.push_back(
        {.index = i, .stamp = stamp, .estimate = estimates[i].world_from_body, .truth = *pose});
  }
  return pairs;
}

Twist mean_twist(const RigidTransform& world_from_camera_before,
                 const RigidTransform& world_from_camera_after, double dt_s) {
  const Eigen::Vector3d rotation =
      so3_log(world_from_camera_before.rotation.conjugate() * world_from_camera_after.rotation);
  const Eigen::Quaterniond half_way = world_from_camera_before.rotation * so3_exp(0.5 * rotation);
  const Eigen::Vector3d chord =
      world_from_camera_after.translation - world_from_camera_before.translation;
  return {.velocity_m_s = half_way.conjugate() * chord / dt_s,
          .angular_rate_rad_s = rotation / dt_s};
}

}  // namespace stillkite
