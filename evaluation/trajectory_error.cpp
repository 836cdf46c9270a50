#include "evaluation/trajectory_error.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/euler.hpp"

namespace stillkite {
namespace {

/// Angle of the twist about the world's z in swing * twist = rotation.
double twist_about_vertical_rad(const Eigen::Quaterniond& rotation) {
  return wrap_angle_rad(2 * std::atan2(rotation.z(), rotation.w()));
}

/// True path length from the first pair to every pair, m.
std::vector<double> arc_lengths_m(std::span<const PosePair> pairs) {
  std::vector<double> lengths(pairs.size(), 0.0);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    lengths[i] =
        lengths[i - 1] + (pairs[i].truth.translation - pairs[i - 1].truth.translation).norm();
  }
  return lengths;
}

using Steps = std::vector<std::pair<std::size_t, std::size_t>>;

std::optional<RelativeError> relative_error(std::span<const PosePair> pairs, Steps steps) {
  std::erase_if(steps, [&](const auto& step) {
    return !pairs[step.first].is_metric || !pairs[step.second].is_metric;
  });
  if (steps.empty()) return std::nullopt;
  const std::vector<double> arc_m = arc_lengths_m(pairs);
  RelativeError result{.count = static_cast<int>(steps.size())};
  const double n = static_cast<double>(steps.size());
  double squared_rad2 = 0;
  for (const auto& [from, to] : steps) {
    const RigidTransform truth = pairs[from].truth.inverse() * pairs[to].truth;
    const RigidTransform estimate = pairs[from].estimate.inverse() * pairs[to].estimate;
    const RigidTransform error = truth.inverse() * estimate;
    const double angle_rad = so3_log(error.rotation).norm();
    result.translation_rmse_m += error.translation.squaredNorm() / n;
    squared_rad2 += angle_rad * angle_rad / n;
    result.mean_length_m += (arc_m[to] - arc_m[from]) / n;
  }
  result.translation_rmse_m = std::sqrt(result.translation_rmse_m);
  if (pairs.front().has_attitude) result.rotation_rmse_rad = std::sqrt(squared_rad2);
  return result;
}

std::optional<PositionError> position_error(std::span<const PosePair> pairs) {
  PositionError result;
  double sum_m2 = 0;
  int samples = 0;
  for (const PosePair& pair : pairs) {
    if (!pair.is_metric) continue;
    const double distance_m = (pair.estimate.translation - pair.truth.translation).norm();
    sum_m2 += distance_m * distance_m;
    result.max_m = std::max(result.max_m, distance_m);
    ++samples;
  }
  if (samples < 2) return std::nullopt;
  result.rmse_m = std::sqrt(sum_m2 / samples);
  if (const PosePair& last = pairs.back(); last.is_metric) {
    const Eigen::Vector3d error_m = last.estimate.translation - last.truth.translation;
    result.end = {.horizontal_m = error_m.head<2>().norm(), .vertical_m = std::abs(error_m.z())};
  }
  return result;
}

AttitudeError attitude_error(std::span<const PosePair> pairs) {
  AttitudeError result;
  const double n = static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    const Eigen::Quaterniond error = pair.estimate.rotation * pair.truth.rotation.conjugate();
    const double tilt = tilt_rad(error);
    const double yaw = twist_about_vertical_rad(error);
    result.tilt_rmse_rad += tilt * tilt / n;
    result.yaw_rmse_rad += yaw * yaw / n;
  }
  result.tilt_rmse_rad = std::sqrt(result.tilt_rmse_rad);
  result.yaw_rmse_rad = std::sqrt(result.yaw_rmse_rad);
  return result;
}

}  // namespace

std::optional<TrajectoryError> trajectory_error(std::span<const PosePair> pairs) {
  if (pairs.size() < 2) return std::nullopt;
  TrajectoryError result{.position = position_error(pairs), .attitude = {}};
  if (pairs.front().has_attitude) result.attitude = attitude_error(pairs);
  return result;
}

double path_length_m(std::span<const PosePair> pairs) {
  return pairs.empty() ? 0.0 : arc_lengths_m(pairs).back();
}

std::optional<RelativeError> relative_error_over_frames(std::span<const PosePair> pairs,
                                                        int frames) {
  Steps steps;
  const auto step = static_cast<std::size_t>(frames);
  for (std::size_t i = 0; i + step < pairs.size(); ++i) steps.emplace_back(i, i + step);
  return relative_error(pairs, std::move(steps));
}

std::optional<RelativeError> relative_error_over_distance(std::span<const PosePair> pairs,
                                                          double distance_m) {
  const std::vector<double> arc_m = arc_lengths_m(pairs);
  Steps steps;
  for (std::size_t i = 0; i < arc_m.size(); ++i) {
    const auto end = std::lower_bound(arc_m.begin() + static_cast<std::ptrdiff_t>(i), arc_m.end(),
                                      arc_m[i] + distance_m);
    if (end == arc_m.end()) break;
    steps.emplace_back(i, static_cast<std::size_t>(end - arc_m.begin()));
  }
  return relative_error(pairs, std::move(steps));
}

}  // namespace stillkite
