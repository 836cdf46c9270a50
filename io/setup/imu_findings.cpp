#include "io/setup/imu_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "geometry/gravity.hpp"
#include "geometry/median.hpp"
#include "io/dataset/sensor_checks.hpp"

namespace stillkite {
namespace {

// Standard deviation of the noise of one axis in a window of readings, by second differences.
double noise_of(const TimeSeries<Vector6d>& imu, std::size_t begin, std::size_t end, int axis) {
  double sum = 0;
  for (std::size_t i = begin + 1; i + 1 < end; ++i) {
    const double d = imu.values[i - 1](axis) - 2 * imu.values[i](axis) + imu.values[i + 1](axis);
    sum += d * d;
  }
  return std::sqrt(sum / (6 * static_cast<double>(end - begin - 2)));
}

}  // namespace

TimeSeries<Vector6d> with_swapped_columns(TimeSeries<Vector6d> imu) {
  for (Vector6d& value : imu.values) {
    const Eigen::Vector3d first = value.head<3>();
    value.head<3>() = value.tail<3>().eval();
    value.tail<3>() = first;
  }
  return imu;
}

bool has_swapped_columns(const TimeSeries<Vector6d>& imu) {
  constexpr double kMaxDeviation = 0.25;
  std::vector<double> as_forces = mean_force_magnitudes_m_s2(imu);
  std::vector<double> as_rates = mean_force_magnitudes_m_s2(with_swapped_columns(imu));
  return std::abs(upper_median(as_rates) / kGravity_m_s2 - 1) < kMaxDeviation &&
         upper_median(as_forces) < kMaxDeviation * kGravity_m_s2;
}

SetupFinding gravity_size_finding(const TimeSeries<Vector6d>& imu) {
  constexpr double kMaxDeviation = 0.05, kMaxWrong = 0.25, kSigmas = 5;
  std::vector<double> means = mean_force_magnitudes_m_s2(imu);
  const double middle = median(means);
  // standard error of a median: 1.25 / sqrt(n) standard deviations, 1.48 median deviations
  std::vector<double> deviations;
  deviations.reserve(means.size());
  for (const double mean : means) deviations.push_back(std::abs(mean - middle));
  const double sigma =
      1.25 * 1.48 * median(deviations) / std::sqrt(static_cast<double>(means.size()));
  const double deviation = std::abs(middle / kGravity_m_s2 - 1);
  const bool is_significant =
      std::abs(middle - kGravity_m_s2) > kSigmas * sigma && deviation > kMaxDeviation;
  SetupFinding out{.question = "size of gravity",
                   .verdict = deviation <= kMaxDeviation ? SetupVerdict::ok
                              : !is_significant          ? SetupVerdict::cannot_tell
                              : deviation <= kMaxWrong   ? SetupVerdict::doubtful
                                                         : SetupVerdict::wrong,
                   .text = fmt::format("mean specific force {:.4g} +- {:.2g} m/s^2 (bound {:.4g} "
                                       "+- {:g} %)",
                                       middle, sigma, kGravity_m_s2, 100 * kMaxDeviation),
                   .measured = SetupMeasurement{middle, sigma, kGravity_m_s2, "m/s^2"}};
  if (out.verdict == SetupVerdict::doubtful) {
    out.remedy = fmt::format("calibrate the accelerometer: scale {:.4f}", kGravity_m_s2 / middle);
  } else if (out.verdict == SetupVerdict::wrong) {
    const std::optional<ForceUnit> unit = probable_force_unit(middle);
    if (unit) out.text += fmt::format(": the unit is {} instead of m/s^2", unit->name);
    out.remedy = unit ? fmt::format("multiply ax, ay, az of the log by {:.6g}", unit->factor)
                      : "log the specific force in m/s^2, gravity included (+9.81 upward at rest)";
  }
  return out;
}

std::optional<ImuDensities> measured_densities(const TimeSeries<Vector6d>& imu) {
  constexpr double kWindow_s = 0.5;
  constexpr std::size_t kMinReadings = 5;
  const std::optional<double> interval_s = median_interval_s(imu.stamps);
  if (!interval_s || seconds_between(imu.stamps.front(), imu.stamps.back()) < 2 * kWindow_s) {
    return std::nullopt;
  }
  const auto length =
      std::max(kMinReadings, static_cast<std::size_t>(std::llround(kWindow_s / *interval_s)));
  std::vector<double> gyro, accel;
  for (std::size_t begin = 0; begin + length <= imu.stamps.size(); begin += length) {
    for (int axis = 0; axis < 3; ++axis) {
      gyro.push_back(noise_of(imu, begin, begin + length, axis));
      accel.push_back(noise_of(imu, begin, begin + length, axis + 3));
    }
  }
  if (gyro.empty()) return std::nullopt;
  return ImuDensities{upper_median(gyro) * std::sqrt(*interval_s),
                      upper_median(accel) * std::sqrt(*interval_s)};
}

SetupFinding imu_noise_finding(const TimeSeries<Vector6d>& imu, const ImuDensities& configured) {
  constexpr double kMaxRatio = 10;
  SetupFinding out{.question = "imu noise"};
  const std::optional<ImuDensities> measured = measured_densities(imu);
  if (!measured) {
    out.text = "the log is shorter than 1 s";
    return out;
  }
  const double ratio =
      std::max(measured->gyro / configured.gyro, measured->accel / configured.accel);
  out.measured = SetupMeasurement{ratio, {}, kMaxRatio, "of the configured density"};
  out.text = fmt::format(
      "gyroscope {:.2g} rad/s/sqrt(Hz), accelerometer {:.2g} m/s^2/sqrt(Hz), vibration included "
      "(bounds {:.2g} and {:.2g}, {:g} times the configured values)",
      measured->gyro, measured->accel, kMaxRatio * configured.gyro, kMaxRatio * configured.accel,
      kMaxRatio);
  out.verdict = ratio <= kMaxRatio ? SetupVerdict::ok : SetupVerdict::doubtful;
  if (out.verdict != SetupVerdict::ok) {
    out.remedy = fmt::format("imu: {{noise: {{gyro_density: {:.2g}, accel_density: {:.2g}}}}}",
                             std::max(measured->gyro, configured.gyro),
                             std::max(measured->accel, configured.accel));
  }
  return out;
}

std::optional<UpDirection> up_direction(const TimeSeries<Vector6d>& imu, Timestamp first,
                                        const std::optional<Eigen::Vector3d>& gyro_bias_rad_s) {
  constexpr double kRotated_s = 10, kFixed_s = 2, kBlock_s = 0.2, kMinDuration_s = 1;
  const double duration_s = gyro_bias_rad_s ? kRotated_s : kFixed_s;
  Eigen::Quaterniond first_from_body = Eigen::Quaterniond::Identity();
  std::vector<Eigen::Vector3d> means;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  std::optional<Timestamp> last, block;
  for (std::size_t i = 0; i < imu.stamps.size(); ++i) {
    const Timestamp stamp = imu.stamps[i];
    if (stamp < first) continue;
    if (seconds_between(first, stamp) > duration_s) break;
    if (last) {
      const double dt_s = seconds_between(*last, stamp);
      if (dt_s > imu.max_gap_s) break;
      if (gyro_bias_rad_s) {
        const Eigen::Vector3d rate = imu.values[i].head<3>() - *gyro_bias_rad_s;
        first_from_body = (first_from_body * so3_exp(dt_s * rate)).normalized();
      }
    }
    last = stamp;
    if (!block) block = stamp;
    sum += first_from_body * imu.values[i].tail<3>();
    ++count;
    if (seconds_between(*block, stamp) < kBlock_s) continue;
    means.emplace_back(sum / count);
    sum.setZero();
    count = 0;
    block.reset();
  }
  const double n = static_cast<double>(means.size());
  if (n * kBlock_s < kMinDuration_s) return std::nullopt;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& value : means) mean += value / n;
  if (!(mean.norm() > 0)) return std::nullopt;
  double spread2 = 0;  // of one horizontal component
  for (const Eigen::Vector3d& value : means) {
    spread2 += 0.5 * (value - mean).cross(mean.normalized()).squaredNorm() / (n - 1);
  }
  return UpDirection{.up_in_body = mean.normalized(),
                     .sigma_rad = std::sqrt(spread2 / n) / mean.norm(),
                     .duration_s = n * kBlock_s};
}

SetupFinding initial_attitude_finding(const UpDirection& measured,
                                      const Eigen::Quaterniond& world_from_body,
                                      const char* source) {
  constexpr double kMaxError_rad = 5 * kDegree, kMaxWrong_rad = 20 * kDegree, kSigmas = 3;
  const Eigen::Vector3d up = world_from_body.conjugate() * Eigen::Vector3d::UnitZ();
  const double error_rad = angle_between_rad(up, measured.up_in_body);
  const bool is_significant =
      error_rad > std::max(kMaxError_rad, kSigmas * std::sqrt(2.0) * measured.sigma_rad);
  const EulerAngles level = attitude_of_up(measured.up_in_body);
  SetupFinding out{
      .question = "direction of gravity",
      .verdict = error_rad <= kMaxError_rad   ? SetupVerdict::ok
                 : !is_significant            ? SetupVerdict::cannot_tell
                 : error_rad <= kMaxWrong_rad ? SetupVerdict::doubtful
                                              : SetupVerdict::wrong,
      .text = fmt::format("{:.1f} +- {:.1f} deg from the initial attitude by {} (bound {:g} deg); "
                          "measured roll {:.1f}, pitch {:.1f} deg in {:.1f} s",
                          error_rad / kDegree, measured.sigma_rad / kDegree, source,
                          kMaxError_rad / kDegree, level.roll_rad / kDegree,
                          level.pitch_rad / kDegree, measured.duration_s),
      .measured = SetupMeasurement{error_rad / kDegree, measured.sigma_rad / kDegree,
                                   kMaxError_rad / kDegree, "deg"}};
  if (out.verdict != SetupVerdict::ok) {
    out.remedy = fmt::format("initial: {{roll_deg: {:.1f}, pitch_deg: {:.1f}}}",
                             level.roll_rad / kDegree, level.pitch_rad / kDegree);
  }
  return out;
}

}  // namespace stillkite
