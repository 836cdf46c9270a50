#include "io/setup/height_findings.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "geometry/median.hpp"
#include "navigation/sensor_readings.hpp"

namespace stillkite {
namespace {

using Eigen::Vector3d;
using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

// Interval between two frames of the flow.
struct ForceInterval {
  Vector3d velocity_change = Vector3d::Zero();  // of the flow
  Vector3d force_integral = Vector3d::Zero();   // of R f, m/s
  Eigen::Matrix3d attitude_integral = Eigen::Matrix3d::Zero();
  double dt_s = 0;
  double noise2 = 0;  // variance of the velocity change, three axes
};

// Unbroken intervals of at least kInterval_s.
std::vector<ForceInterval> force_intervals(std::span<const FlowMotion> flow,
                                           const TimeSeries<Vector6d>& imu) {
  constexpr double kInterval_s = 0.4, kMaxFrameGap_s = 0.2;
  std::vector<ForceInterval> out;
  ForceInterval sum;
  std::size_t begin = 0, reading = 0;
  for (std::size_t i = 1; i < flow.size(); ++i) {
    const FlowMotion &before = flow[i - 1], &after = flow[i];
    const double dt_s = seconds_between(before.stamp, after.stamp);
    while (reading < imu.stamps.size() && imu.stamps[reading] <= before.stamp) ++reading;
    Vector3d mean = Vector3d::Zero();
    int count = 0;
    for (; reading < imu.stamps.size() && imu.stamps[reading] <= after.stamp; ++reading, ++count) {
      const double ratio = seconds_between(before.stamp, imu.stamps[reading]) / dt_s;
      mean += before.world_from_body.rotation.slerp(ratio, after.world_from_body.rotation) *
              imu.values[reading].tail<3>();
    }
    if (dt_s > kMaxFrameGap_s || count == 0) {
      sum = {};
      begin = i;
      continue;
    }
    sum.force_integral += dt_s * mean / count;
    sum.attitude_integral += dt_s * after.world_from_body.rotation.toRotationMatrix();
    sum.dt_s += dt_s;
    if (sum.dt_s < kInterval_s) continue;
    sum.velocity_change = after.velocity_in_world - flow[begin].velocity_in_world;
    sum.noise2 = 3 * (after.velocity_sigma * after.velocity_sigma +
                      flow[begin].velocity_sigma * flow[begin].velocity_sigma);
    out.push_back(std::exchange(sum, {}));
    begin = i;
  }
  return out;
}

// Scale of least squares.
template <typename Excluded>
double scale_by_forces(std::span<const ForceInterval> intervals, const Excluded& excluded) {
  constexpr double kBiasSigma_m_s2 = 0.3;
  double variance = 0.01;  // m^2/s^2, of a residual
  Vector7d x = Vector7d::Zero();
  for (int iteration = 0; iteration < 3; ++iteration) {
    Matrix7d H = Matrix7d::Zero();
    Vector7d b = Vector7d::Zero();
    double yy = 0;
    int count = 0;
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      if (excluded(i)) continue;
      Eigen::Matrix<double, 3, 7> A;
      A << intervals[i].velocity_change, -intervals[i].dt_s * Eigen::Matrix3d::Identity(),
          intervals[i].attitude_integral;
      H += A.transpose() * A;
      b += A.transpose() * intervals[i].force_integral;
      yy += intervals[i].force_integral.squaredNorm();
      ++count;
    }
    Matrix7d with_prior = H;
    with_prior.diagonal().tail<3>().array() += variance / (kBiasSigma_m_s2 * kBiasSigma_m_s2);
    x = with_prior.ldlt().solve(b);
    const double residual2 = yy - 2 * x.dot(b) + x.dot(H * x);
    variance = std::max(residual2, 1e-9) / std::max(3 * count - 4, 1);
  }
  return x(0);
}

// Position of the truth, linear between poses at most 1.5 s apart.
std::optional<Vector3d> position_at(std::span<const StampedPose> poses, Timestamp stamp) {
  constexpr double kMaxInterval_s = 1.5;
  const auto after = std::ranges::lower_bound(poses, stamp, {}, &StampedPose::stamp);
  if (after == poses.end()) return std::nullopt;
  if (after->stamp == stamp) return after->world_from_body.translation;
  if (after == poses.begin()) return std::nullopt;
  const StampedPose& before = *std::prev(after);
  const double interval_s = seconds_between(before.stamp, after->stamp);
  if (interval_s > kMaxInterval_s) return std::nullopt;
  return interpolate(before.world_from_body, after->world_from_body,
                     seconds_between(before.stamp, stamp) / interval_s)
      .translation;
}

// Positions by the sum of the velocities, for a truth without poses.
std::vector<StampedPose> integrated(std::span<const StampedVelocity> velocities) {
  std::vector<StampedPose> poses;
  Vector3d position = Vector3d::Zero();
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    if (i > 0) {
      const double dt_s = seconds_between(velocities[i - 1].stamp, velocities[i].stamp);
      position += 0.5 * dt_s *
                  (velocities[i - 1].velocity_in_world_m_s + velocities[i].velocity_in_world_m_s);
    }
    poses.push_back({velocities[i].stamp, {Eigen::Quaterniond::Identity(), position}});
  }
  return poses;
}

struct LengthUnit {
  const char* name;
  double metres;
};

// Unit in which a height is given that is `ratio` times too large a number.
std::optional<LengthUnit> length_unit_of(double metres_per_unit) {
  constexpr double kMaxDeviation = 0.15;
  constexpr std::array<LengthUnit, 4> kUnits{
      {{"feet", 0.3048}, {"centimetres", 0.01}, {"millimetres", 0.001}, {"kilometres", 1000}}};
  for (const LengthUnit& unit : kUnits) {
    if (std::abs(metres_per_unit / unit.metres - 1) < kMaxDeviation) return unit;
  }
  return std::nullopt;
}

}  // namespace

std::optional<BlockEstimate> inertial_scale(std::span<const FlowMotion> flow,
                                            const TimeSeries<Vector6d>& imu) {
  constexpr std::size_t kMinIntervals = 20;
  constexpr double kMaxAttenuation = 0.05;
  const std::vector<ForceInterval> intervals = force_intervals(flow, imu);
  if (intervals.size() < kMinIntervals) return std::nullopt;
  double signal2 = 0, noise2 = 0;
  for (const ForceInterval& interval : intervals) {
    signal2 += interval.velocity_change.squaredNorm();
    noise2 += interval.noise2;
  }
  if (noise2 > kMaxAttenuation * signal2) return std::nullopt;
  return block_jackknife(
      intervals.size(), [&](const auto& excluded) { return scale_by_forces(intervals, excluded); });
}

std::optional<BlockEstimate> scale_of_truth(std::span<const FlowMotion> flow,
                                            const GroundTruth& truth) {
  constexpr double kInterval_s = 0.5, kMaxFrameGap_s = 0.4;
  constexpr std::size_t kMinIntervals = 10;
  const std::vector<StampedPose> poses =
      truth.poses.empty() ? integrated(truth.velocities) : truth.poses;
  std::vector<std::pair<double, double>> lengths;  // of the flow, of the truth
  std::size_t begin = 0;
  for (std::size_t i = 1; i < flow.size(); ++i) {
    if (seconds_between(flow[i - 1].stamp, flow[i].stamp) > kMaxFrameGap_s) begin = i;
    if (seconds_between(flow[begin].stamp, flow[i].stamp) < kInterval_s) continue;
    const auto from = position_at(poses, flow[begin].stamp), to = position_at(poses, flow[i].stamp);
    if (from && to) {
      lengths.emplace_back(
          (flow[i].world_from_body.translation - flow[begin].world_from_body.translation).norm(),
          (*to - *from).norm());
    }
    begin = i;
  }
  if (lengths.size() < kMinIntervals) return std::nullopt;
  return block_jackknife(lengths.size(), [&](const auto& excluded) {
    double by_flow = 0, product = 0;
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      if (excluded(i)) continue;
      by_flow += lengths[i].first * lengths[i].first;
      product += lengths[i].first * lengths[i].second;
    }
    return product / by_flow;
  });
}

SetupFinding height_finding(std::optional<double> height_m,
                            const std::optional<BlockEstimate>& scale, const char* source) {
  constexpr double kMaxError = 0.15, kMaxWrong = 0.5, kMinSignificance = 5;
  constexpr double kMaxSigma = 0.1;
  SetupFinding out{.question = "initial height"};
  if (!scale || !(scale->value > 0) || scale->sigma > kMaxSigma * scale->value) {
    out.text = height_m ? fmt::format("{:.4g} m, no metric scale to compare with", *height_m)
                        : "unknown, and no metric scale was measured";
    if (scale) {
      out.text += fmt::format(" ({}: factor {:.2g} +- {:.2g}, sigma of {:g} % needed)", source,
                              scale->value, scale->sigma, 100 * kMaxSigma);
    }
    if (!height_m) out.remedy = "initial: {height_m: METRES}";
    return out;
  }
  if (!height_m) {
    out.text = fmt::format("unknown; {:.3g} +- {:.2g} m by {}", scale->value, scale->sigma, source);
    out.remedy = fmt::format("initial: {{height_m: {:.3g}}}", scale->value);
    out.measured = SetupMeasurement{scale->value, scale->sigma, {}, "m"};
    return out;
  }
  const double error = std::max(scale->value, 1 / scale->value) - 1;
  const bool is_significant = error > kMaxError && scale->sigmas_from(1) > kMinSignificance;
  out.verdict = error <= kMaxError   ? SetupVerdict::ok
                : !is_significant    ? SetupVerdict::cannot_tell
                : error <= kMaxWrong ? SetupVerdict::doubtful
                                     : SetupVerdict::wrong;
  out.measured = SetupMeasurement{scale->value, scale->sigma, 1 + kMaxError, "ratio"};
  out.text =
      fmt::format("{:.4g} m; {:.3g} +- {:.2g} m by {} (bound {:g} %)", *height_m,
                  *height_m * scale->value, *height_m * scale->sigma, source, 100 * kMaxError);
  if (!is_significant) return out;
  if (const auto unit = length_unit_of(scale->value)) {
    out.text += fmt::format(": {} instead of metres", unit->name);
  }
  out.remedy = fmt::format("initial: {{height_m: {:.3g}}}", *height_m * scale->value);
  return out;
}

SetupFinding height_sensor_finding(std::span<const FlowMotion> flow, const SensorLog& sensors,
                                   std::optional<double> configured_height_m) {
  constexpr double kMaxError = 0.15, kMaxWrong = 0.5, kMinSignificance = 5, kMaxSigma = 0.1;
  constexpr double kMinChange = 0.03;
  constexpr std::size_t kMinFrames = 50;
  SetupFinding out{.question = "height sensor"};
  const bool is_range = sensors.height_source == ScaleSource::range;
  std::vector<std::pair<double, double>> heights;  // by the flow, by the sensor
  double flow_sum = 0, sensor_sum = 0;
  std::optional<Timestamp> before;
  for (const FlowMotion& motion : flow) {
    const auto reading =
        readings_between(sensors, before.value_or(motion.stamp), motion.stamp).height_m;
    before = motion.stamp;
    if (!reading) continue;
    heights.emplace_back(
        motion.world_from_body.translation.z(),
        height_of_body_m(*reading, sensors.height_source, motion.world_from_body.rotation));
    flow_sum += heights.back().first;
    sensor_sum += heights.back().second;
  }
  const auto count = static_cast<double>(heights.size());
  if (heights.size() < kMinFrames) {
    out.text = fmt::format("{} readings at images that the flow measured, {} needed",
                           heights.size(), kMinFrames);
    return out;
  }
  const double flow_mean = flow_sum / count, sensor_mean = sensor_sum / count;
  if (is_range && configured_height_m) {
    // one height for both: the ratio of the means
    const double ratio = sensor_mean / flow_mean;
    if (std::max(ratio, 1 / ratio) - 1 > kMaxWrong) {
      out.verdict = SetupVerdict::wrong;
      out.measured = SetupMeasurement{ratio, {}, 1 + kMaxError, "ratio"};
      out.text = fmt::format(
          "mean {:.4g}, by the initial height and the flow {:.4g} m (factor "
          "{:.3g}, bound {:g} %)",
          sensor_mean, flow_mean, ratio, 100 * kMaxError);
      if (const auto unit = length_unit_of(1 / ratio)) {
        out.text += fmt::format(": {} instead of metres", unit->name);
        out.remedy = fmt::format("multiply the heights of the log by {:g}", unit->metres);
      } else {
        out.remedy = "give the log and initial.height_m in metres";
      }
      return out;
    }
  }
  double flow_variance = 0;
  for (const auto& height : heights) {
    flow_variance += (height.first - flow_mean) * (height.first - flow_mean) / count;
  }
  const double change = std::sqrt(flow_variance) / flow_mean;
  if (change < kMinChange) {
    out.text = fmt::format("the height changes by {:.2g} % (standard deviation), {:g} % needed",
                           100 * change, 100 * kMinChange);
    return out;
  }
  // slope of the sensor over the flow; for a range both are proportional
  const double unit = is_range ? sensor_mean / flow_mean : 1;
  const BlockEstimate slope = block_jackknife(heights.size(), [&](const auto& excluded) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      if (excluded(i)) continue;
      n += 1;
      x += heights[i].first;
      y += heights[i].second;
      xx += heights[i].first * heights[i].first;
      xy += heights[i].first * heights[i].second;
    }
    return (xy / n - x * y / (n * n)) / std::max(xx / n - x * x / (n * n), 1e-12) / unit;
  });
  if (!(slope.sigma < kMaxSigma * std::max(std::abs(slope.value), 1.0))) {
    out.text = fmt::format(
        "changes by {:.2g} +- {:.2g} of the flow's change of height, sigma of {:g} "
        "needed: climb or descend more",
        slope.value, slope.sigma, kMaxSigma);
    return out;
  }
  const double error = slope.value > 0 ? std::max(slope.value, 1 / slope.value) - 1 : HUGE_VAL;
  const bool is_significant = error > kMaxError && slope.sigmas_from(1) > kMinSignificance;
  out.verdict = error <= kMaxError   ? SetupVerdict::ok
                : !is_significant    ? SetupVerdict::cannot_tell
                : error <= kMaxWrong ? SetupVerdict::doubtful
                                     : SetupVerdict::wrong;
  out.measured = SetupMeasurement{slope.value, slope.sigma, 1 + kMaxError, "ratio"};
  out.text =
      fmt::format("changes by {:.3g} +- {:.2g} of the flow's change of height (bound {:g} %)",
                  slope.value, slope.sigma, 100 * kMaxError);
  if (!is_significant) return out;
  if (slope.value < 0) {
    out.text += ": positive down";
    out.remedy = "invert the sign of the heights";
  } else if (const auto named = length_unit_of(1 / slope.value)) {
    out.text += fmt::format(": {} instead of metres", named->name);
    out.remedy = fmt::format("multiply the heights of the log by {:g}", named->metres);
  } else {
    out.remedy = is_range
                     ? "remove the offset of the sensor, or its clock's: height: {time_offset_s: S}"
                     : "check its unit, and the clock: height: {time_offset_s: S}";
  }
  return out;
}

}  // namespace stillkite
