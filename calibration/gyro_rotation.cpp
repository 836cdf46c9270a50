#include "calibration/gyro_rotation.hpp"

#include <algorithm>

#include "geometry/rigid_transform.hpp"

namespace stillkite {

GyroReadings::GyroReadings(std::span<const Timestamp> stamps,
                           std::span<const Eigen::Vector3d> rates_rad_s)
    : origin_(stamps.empty() ? Timestamp{} : stamps.front()),
      rates_rad_s_(rates_rad_s.begin(), rates_rad_s.end()) {
  for (const Timestamp stamp : stamps) t_s_.push_back(seconds_between(origin_, stamp));
}

Eigen::Vector3d GyroReadings::at(std::size_t next, double t_s) const {
  const double ratio = (t_s - t_s_[next - 1]) / (t_s_[next] - t_s_[next - 1]);
  return (1 - ratio) * rates_rad_s_[next - 1] + ratio * rates_rad_s_[next];
}

std::optional<GyroRotation> GyroReadings::between(Timestamp from, Timestamp to, double offset_s,
                                                  const Eigen::Vector3d& bias_rad_s) const {
  const double begin_s = seconds_between(origin_, from) + offset_s;
  const double end_s = seconds_between(origin_, to) + offset_s;
  if (t_s_.empty() || begin_s < t_s_.front() || end_s >= t_s_.back()) return std::nullopt;
  auto next = static_cast<std::size_t>(std::ranges::upper_bound(t_s_, begin_s) - t_s_.begin());
  GyroRotation out;
  const Eigen::Vector3d first = at(next, begin_s) - bias_rad_s;
  Eigen::Vector3d rate = first;
  for (double t_s = begin_s; t_s < end_s; ++next) {
    const double step_s = std::min(t_s_[next], end_s) - t_s;
    const Eigen::Vector3d next_rate = at(next, t_s + step_s) - bias_rad_s;
    const Eigen::Vector3d rotation_rad = 0.5 * step_s * (rate + next_rate);
    const Eigen::Matrix3d step = so3_exp(rotation_rad).toRotationMatrix();
    out.rotation *= step;
    // right Jacobian: that of the opposite rotation on the left
    out.by_bias = step.transpose() * out.by_bias - step_s * so3_left_jacobian(-rotation_rad);
    rate = next_rate;
    t_s += step_s;
    if (t_s_[next] >= end_s) break;
  }
  out.by_offset = rate - out.rotation.transpose() * first;
  return out;
}

}  // namespace stillkite
