#include "evaluation/truth_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "evaluation/alignment.hpp"
#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using Cause = TruthMismatch::Cause;

struct StampedSpeed {
  double t_s = 0;
  double speed_m_s = 0;
};

// Speeds between poses about 0.2 s apart, at their middle.
std::vector<StampedSpeed> speeds_of(std::span<const StampedPose> poses, Timestamp origin) {
  constexpr double kInterval_s = 0.2, kMaxInterval_s = 1.5;
  std::vector<StampedSpeed> speeds;
  std::size_t before = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    while (before + 1 < i && seconds_between(poses[before + 1].stamp, poses[i].stamp) > kInterval_s)
      ++before;
    const double dt_s = seconds_between(poses[before].stamp, poses[i].stamp);
    if (dt_s < 0.5 * kInterval_s || dt_s > kMaxInterval_s) continue;
    const double length_m =
        (poses[i].world_from_body.translation - poses[before].world_from_body.translation).norm();
    speeds.push_back({seconds_between(origin, poses[i].stamp) - 0.5 * dt_s, length_m / dt_s});
  }
  return speeds;
}

std::vector<StampedSpeed> speeds_of(const Truth& truth, Timestamp origin) {
  std::vector<StampedSpeed> speeds;
  for (const StampedVelocity& row : truth.velocities) {
    speeds.push_back({seconds_between(origin, row.stamp), row.velocity_in_world_m_s.norm()});
  }
  return speeds.empty() ? speeds_of(truth.poses, origin) : speeds;
}

// Speeds at multiples of `step_s`, linear between neighbours at most 1.5 s apart; else NaN.
std::vector<double> resampled(std::span<const StampedSpeed> speeds, double first_s, double step_s,
                              std::size_t count) {
  constexpr double kMaxInterval_s = 1.5;
  std::vector<double> values(count, std::numeric_limits<double>::quiet_NaN());
  std::size_t after = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double t_s = first_s + step_s * static_cast<double>(i);
    while (after < speeds.size() && speeds[after].t_s < t_s) ++after;
    if (after == 0 || after == speeds.size()) continue;
    const StampedSpeed& a = speeds[after - 1];
    const StampedSpeed& b = speeds[after];
    if (b.t_s - a.t_s > kMaxInterval_s) continue;
    const double ratio = (t_s - a.t_s) / (b.t_s - a.t_s);
    values[i] = a.speed_m_s + ratio * (b.speed_m_s - a.speed_m_s);
  }
  return values;
}

// Mean squared difference of estimate[i] and truth[i + lag + margin]; infinity with few samples.
double mean_squared_difference(std::span<const double> estimate, std::span<const double> truth,
                               std::ptrdiff_t shift, std::size_t min_samples) {
  const std::size_t stride = std::max<std::size_t>(1, estimate.size() / 500);
  double sum = 0;
  std::size_t samples = 0;
  for (std::size_t i = 0; i < estimate.size(); i += stride) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(i) + shift;
    if (at < 0 || at >= std::ssize(truth)) continue;
    const double difference = estimate[i] - truth[static_cast<std::size_t>(at)];
    if (std::isnan(difference)) continue;
    sum += difference * difference;
    ++samples;
  }
  if (samples * stride < min_samples) return std::numeric_limits<double>::infinity();
  return sum / static_cast<double>(samples);
}

std::optional<TruthMismatch> clock_mismatch(std::span<const StampedPose> estimates,
                                            const Truth& truth) {
  constexpr double kMinStep_s = 0.01, kMaxSamples = 20'000, kMaxOffset_s = 10;
  constexpr double kMinOffset_s = 0.03, kMaxRatio = 0.25, kMinError_m_s = 0.02;
  if (estimates.size() < 20) return std::nullopt;
  const Timestamp origin = estimates.front().stamp;
  const double duration_s = seconds_between(origin, estimates.back().stamp);
  const double step_s = std::max(kMinStep_s, duration_s / kMaxSamples);
  const auto margin = static_cast<std::ptrdiff_t>(std::min(kMaxOffset_s, duration_s / 3) / step_s);
  const auto count = static_cast<std::size_t>(duration_s / step_s) + 1;
  const std::vector<double> estimated = resampled(speeds_of(estimates, origin), 0, step_s, count);
  const std::vector<double> known =
      resampled(speeds_of(truth, origin), -static_cast<double>(margin) * step_s, step_s,
                count + 2 * static_cast<std::size_t>(margin));
  const auto difference = [&](std::ptrdiff_t lag) {
    return mean_squared_difference(estimated, known, margin + lag, count / 2);
  };
  std::ptrdiff_t best = 0;
  double least = difference(0);
  const double as_given = least;
  for (std::ptrdiff_t lag = -margin; lag <= margin; ++lag) {
    if (const double value = difference(lag); value < least) {
      least = value;
      best = lag;
    }
  }
  if (!std::isfinite(as_given) || as_given < kMinError_m_s * kMinError_m_s ||
      least > kMaxRatio * as_given || std::abs(static_cast<double>(best) * step_s) < kMinOffset_s) {
    return std::nullopt;
  }
  const double before = difference(best - 1), after = difference(best + 1);
  const double curvature = before - 2 * least + after;
  const double vertex =
      std::isfinite(curvature) && curvature > 0 ? 0.5 * (before - after) / curvature : 0;
  return TruthMismatch{Cause::clock, step_s * (static_cast<double>(best) + vertex),
                       1 - std::sqrt(least / as_given)};
}

struct Extent {
  Eigen::Vector3d estimate_mean = Eigen::Vector3d::Zero(), truth_mean = Eigen::Vector3d::Zero();
};

Extent means_of(std::span<const PosePair> pairs) {
  Extent extent;
  const auto n = static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    extent.estimate_mean += pair.estimate.translation / n;
    extent.truth_mean += pair.truth.translation / n;
  }
  return extent;
}

// Mean squared difference of truth and scale * estimate about their means.
double mean_squared_distance(std::span<const PosePair> pairs, double scale) {
  const Extent mean = means_of(pairs);
  double sum = 0;
  for (const PosePair& pair : pairs) {
    sum += (pair.truth.translation - mean.truth_mean -
            scale * (pair.estimate.translation - mean.estimate_mean))
               .squaredNorm();
  }
  return sum / static_cast<double>(pairs.size());
}

double best_scale(std::span<const PosePair> pairs) {
  const Extent mean = means_of(pairs);
  double product = 0, square = 0;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d x = pair.estimate.translation - mean.estimate_mean;
    product += x.dot(pair.truth.translation - mean.truth_mean);
    square += x.squaredNorm();
  }
  return square > 0 ? product / square : 1;
}

std::vector<PosePair> without_height(std::vector<PosePair> pairs) {
  for (PosePair& pair : pairs) {
    pair.estimate.translation.z() = 0;
    pair.truth.translation.z() = 0;
  }
  return pairs;
}

std::optional<TruthMismatch> frame_mismatch(std::vector<PosePair> pairs) {
  constexpr double kMinRotation_rad = 5 * kDegree, kMaxRotatedRatio = 0.2;
  constexpr double kMinFactor = 3, kMaxScaledRatio = 0.4, kMinExtent_m = 0.5;
  constexpr std::size_t kMinPairs = 10;
  std::erase_if(pairs, [](const PosePair& pair) { return !pair.is_metric; });
  if (pairs.size() < kMinPairs) return std::nullopt;
  const auto rotation = best_alignment(pairs, Alignment::yaw);
  if (!rotation) return std::nullopt;
  const std::vector<PosePair> rotated = aligned(pairs, *rotation);
  // horizontal only: a truth in latitude and longitude has its heights in metres
  const std::vector<PosePair> level = without_height(rotated);
  const double scale = best_scale(level);
  const double level_extent_m = std::sqrt(mean_squared_distance(level, 0));
  const double scaled_m = std::sqrt(mean_squared_distance(level, scale));
  if ((scale > kMinFactor || scale < 1 / kMinFactor) && scale > 0 &&
      level_extent_m > kMinExtent_m * scale && scaled_m < kMaxScaledRatio * level_extent_m) {
    return TruthMismatch{Cause::scale, scale,
                         1 - scaled_m / std::sqrt(mean_squared_distance(level, 1))};
  }
  const double as_given_m = std::sqrt(mean_squared_distance(pairs, 1));
  const double rotated_m = std::sqrt(mean_squared_distance(rotated, 1));
  const double yaw_rad = so3_log(rotation->rigid.rotation).z();
  if (level_extent_m < kMinExtent_m || std::abs(yaw_rad) < kMinRotation_rad ||
      rotated_m > kMaxRotatedRatio * as_given_m) {
    return std::nullopt;
  }
  return TruthMismatch{Cause::heading, yaw_rad, 1 - rotated_m / as_given_m};
}

}  // namespace

std::optional<TruthMismatch> truth_mismatch(std::span<const EvaluatedMotion> estimates,
                                            const Truth& truth, const EvaluationOptions& options) {
  std::vector<StampedPose> poses;
  for (const EvaluatedMotion& estimate : estimates) {
    if (estimate.is_metric) poses.push_back({estimate.stamp, estimate.world_from_body});
  }
  if (const auto mismatch = clock_mismatch(poses, truth)) return mismatch;
  return frame_mismatch(matched_poses(estimates, truth, options.tolerance_s));
}

std::optional<TruthJump> truth_jump(std::span<const StampedPose> truth) {
  constexpr double kMinLength_m = 0.3, kMinRatio = 10, kQuantile = 0.9;
  constexpr std::size_t kMinRows = 20;
  if (truth.size() < kMinRows) return std::nullopt;
  const auto length_m = [&](std::size_t i) {
    return (truth[i].world_from_body.translation - truth[i - 1].world_from_body.translation).norm();
  };
  const auto speed_m_s = [&](std::size_t i) {
    return length_m(i) / seconds_between(truth[i - 1].stamp, truth[i].stamp);
  };
  std::vector<double> sorted;
  for (std::size_t i = 1; i < truth.size(); ++i) sorted.push_back(speed_m_s(i));
  const auto at =
      sorted.begin() + static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(sorted.size()));
  std::nth_element(sorted.begin(), at, sorted.end());
  TruthJump jump;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    if (length_m(i) <= kMinLength_m || speed_m_s(i) <= kMinRatio * *at) continue;
    ++jump.count;
    if (length_m(i) > jump.length_m) {
      jump.length_m = length_m(i);
      jump.stamp = truth[i].stamp;
    }
  }
  return jump.count > 0 ? std::optional(jump) : std::nullopt;
}

}  // namespace stillkite
