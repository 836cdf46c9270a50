#include "io/import/gopro_orientation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillkite {
namespace {

// x right, y down, z forward to x forward, y left, z up.
Eigen::Quaterniond body_from_camera() {
  return {0.5, -0.5, 0.5, -0.5};
}

// Rotation of body axes by the same rotation of camera axes.
Eigen::Quaterniond in_body_axes(const Eigen::Quaterniond& q) {
  return body_from_camera() * q * body_from_camera().conjugate();
}

Eigen::Quaterniond quaternion_of(const Eigen::Vector<double, 5>& sample) {
  const Eigen::Quaterniond q(sample[0], sample[1], sample[2], sample[3]);
  return q.norm() > 0.5 ? q.normalized() : Eigen::Quaterniond::Identity();
}

// Mean angular rate in `b` between the orientations b_from_start at two times.
Eigen::Vector3d rate_between(const Eigen::Quaterniond& before, const Eigen::Quaterniond& after,
                             double interval_s) {
  const Eigen::AngleAxisd rotation(before * after.conjugate());
  const double angle = rotation.angle() > M_PI ? rotation.angle() - 2 * M_PI : rotation.angle();
  return rotation.axis() * (angle / interval_s);
}

Timestamp middle(Timestamp a, Timestamp b) {
  return {a.ns + (b.ns - a.ns) / 2};
}

// Linear interpolation; nullopt outside the series.
std::optional<Eigen::Vector3d> value_at(const TimeSeries<Eigen::Vector3d>& series, Timestamp t) {
  const auto after = std::ranges::upper_bound(series.stamps, t);
  if (after == series.stamps.begin() || after == series.stamps.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - series.stamps.begin());
  const double share = seconds_between(series.stamps[i - 1], t) /
                       seconds_between(series.stamps[i - 1], series.stamps[i]);
  return Eigen::Vector3d((1 - share) * series.values[i - 1] + share * series.values[i]);
}

// Mean of the values in [from, to); nullopt without any.
std::optional<Eigen::Vector3d> mean_in(const TimeSeries<Eigen::Vector3d>& series, Timestamp from,
                                       Timestamp to) {
  const auto begin = std::ranges::lower_bound(series.stamps, from) - series.stamps.begin();
  const auto end = std::ranges::lower_bound(series.stamps, to) - series.stamps.begin();
  if (begin == end) return std::nullopt;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (auto i = begin; i < end; ++i) sum += series.values[static_cast<std::size_t>(i)];
  return Eigen::Vector3d(sum / static_cast<double>(end - begin));
}

}  // namespace

GoproOrientation gopro_orientation(const GoproStream& camera, const GoproStream& image,
                                   const GoproStream& gravity, std::optional<Timestamp> origin) {
  GoproOrientation out;
  const std::size_t frames = camera.samples.size();
  if (frames < 2 || gravity.samples.size() != frames) return out;
  out.stamps = sample_stamps(camera, origin);
  for (std::size_t i = 0; i < frames; ++i) {
    out.camera_from_start.push_back(quaternion_of(camera.samples[i]));
    out.gravity_in_camera.emplace_back(gravity.samples[i].head<3>().normalized());
    if (image.samples.size() == frames) {
      out.image_from_camera.push_back(quaternion_of(image.samples[i]));
    }
  }
  return out;
}

double max_image_rotation_rad(const GoproOrientation& orientation) {
  double out = 0;
  for (const Eigen::Quaterniond& q : orientation.image_from_camera) {
    out = std::max(out, q.angularDistance(Eigen::Quaterniond::Identity()));
  }
  return out;
}

std::optional<double> imu_clock_offset_s(const GoproOrientation& orientation,
                                         const TimeSeries<Eigen::Vector3d>& rate_in_body_rad_s) {
  constexpr int kMax_ms = 60;
  constexpr std::size_t kMaxIntervals = 10'000;
  constexpr double kMinGain = 0.25;  // the best mean square, relative to the worst
  const std::size_t intervals =
      std::min(kMaxIntervals, std::max<std::size_t>(orientation.stamps.size(), 1) - 1);
  double best = std::numeric_limits<double>::infinity(), worst = 0;
  int best_ms = 0;
  for (int offset_ms = -kMax_ms; offset_ms <= kMax_ms; ++offset_ms) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < intervals; ++i) {
      const Timestamp before = orientation.stamps[i], after = orientation.stamps[i + 1];
      const auto rate =
          value_at(rate_in_body_rad_s, {middle(before, after).ns - offset_ms * 1'000'000LL});
      if (!rate || after <= before) continue;
      const Eigen::Vector3d in_camera =
          rate_between(orientation.camera_from_start[i], orientation.camera_from_start[i + 1],
                       seconds_between(before, after));
      sum += (body_from_camera() * in_camera - *rate).squaredNorm();
      ++count;
    }
    if (count == 0) return std::nullopt;
    const double mean = sum / count;
    worst = std::max(worst, mean);
    if (mean < best) {
      best = mean;
      best_ms = offset_ms;
    }
  }
  if (best > kMinGain * worst || std::abs(best_ms) == kMax_ms) return std::nullopt;
  return 1e-3 * best_ms;
}

TimeSeries<Eigen::Quaterniond> gopro_attitude(const GoproOrientation& orientation, bool of_image) {
  TimeSeries<Eigen::Quaterniond> out;
  const Eigen::Vector3d up_in_world = Eigen::Vector3d::UnitZ();
  const auto up_in_body = [&](std::size_t i) {
    return Eigen::Vector3d(body_from_camera() * -orientation.gravity_in_camera[i]);
  };
  const Eigen::Quaterniond world_from_start =
      Eigen::Quaterniond::FromTwoVectors(up_in_body(0), up_in_world);
  const Eigen::Vector3d forward = world_from_start * Eigen::Vector3d::UnitX();
  const Eigen::Quaterniond without_yaw(
      Eigen::AngleAxisd(-std::atan2(forward.y(), forward.x()), up_in_world));
  for (std::size_t i = 0; i < orientation.stamps.size(); ++i) {
    if (!out.stamps.empty() && orientation.stamps[i] <= out.stamps.back()) continue;
    Eigen::Quaterniond q =
        world_from_start * in_body_axes(orientation.camera_from_start[i].conjugate());
    q = Eigen::Quaterniond::FromTwoVectors(q * up_in_body(i), up_in_world) * q;
    if (of_image) q = q * in_body_axes(orientation.image_from_camera[i].conjugate());
    out.stamps.push_back(orientation.stamps[i]);
    out.values.push_back((without_yaw * q).normalized());
  }
  return out;
}

void rotate_imu_with_image(const GoproOrientation& orientation, ImportedFlight& flight) {
  const TimeSeries<Eigen::Vector3d> force = std::move(flight.specific_force_in_body_m_s2);
  flight.angular_rate_in_body_rad_s = {};
  flight.specific_force_in_body_m_s2 = {};
  const auto image_from_start = [&](std::size_t i) {
    return orientation.image_from_camera[i] * orientation.camera_from_start[i];
  };
  for (std::size_t i = 0; i + 1 < orientation.image_from_camera.size(); ++i) {
    const Timestamp before = orientation.stamps[i], after = orientation.stamps[i + 1];
    const auto mean_force = mean_in(force, before, after);
    if (after <= before || !mean_force) continue;
    const Eigen::Quaterniond between =
        orientation.image_from_camera[i].slerp(0.5, orientation.image_from_camera[i + 1]);
    append(flight.angular_rate_in_body_rad_s, middle(before, after),
           Eigen::Vector3d(body_from_camera() * rate_between(image_from_start(i),
                                                             image_from_start(i + 1),
                                                             seconds_between(before, after))),
           flight.rejected);
    append(flight.specific_force_in_body_m_s2, middle(before, after),
           Eigen::Vector3d(in_body_axes(between) * *mean_force), flight.rejected);
  }
}

}  // namespace stillkite
