#include "io/dataset/gyro_check.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::string axes_description(const Matrix3d& axes) {
  if (axes.determinant() < 0) return "one or all gyroscope axes inverted";
  const Eigen::AngleAxisd rotation(axes);
  return fmt::format(
      "gyroscope axes rotated by {:.0f} deg about ({:.1f}, {:.1f}, {:.1f}) (set "
      "rotation_wxyz, body from sensor)",
      rotation.angle() / kDegree, rotation.axis().x(), rotation.axis().y(), rotation.axis().z());
}

struct Hypothesis {
  double explained = 0;
  std::string description;
};

std::string clock_description(const ClockOffset& clock) {
  return fmt::format(
      "a gyroscope clock {:.2f} s {} (add {:+.3f} to time_offset_s)", std::abs(clock.offset_s),
      clock.offset_s > 0 ? "ahead of the images" : "behind the images", -clock.offset_s);
}

}  // namespace

std::optional<std::string> gyro_inconsistency(const TimeSeries<Vector3d>& gyro,
                                              std::span<const ObservedRotation> observed) {
  constexpr int kMinPairs = 10;  // 1 s at least
  constexpr double kConsistentFraction = 0.5, kMinExplainedFraction = 0.6, kMinEnergyRatio = 0.01;
  constexpr double kMaxRateRatio = 10, kMinFast_rad_s = 20 * kDegree;
  constexpr double kMinOffset_s = 0.015, kMinOffsetSigmas = 6;
  const GyroIntegral sum(gyro);
  const std::vector<ObservedRotation> intervals = merged_rotations(observed);
  const RotationSums measured = rotation_sums(sum, intervals, 0);
  if (measured.count < kMinPairs) return std::nullopt;
  const double rate_rad_s = measured.image_rate_rad_s();
  const double gyro_rate_rad_s = measured.gyro_rate_rad_s();
  const double rate_ratio = gyro_rate_rad_s / std::max(rate_rad_s, kMinRotationRate_rad_s);
  const bool is_too_fast = rate_ratio > kMaxRateRatio && gyro_rate_rad_s > kMinFast_rad_s;
  const std::string too_fast = fmt::format(
      "the gyroscope measures {:.0f} deg/s, the images rotate at {:.1f} deg/s; give the angular "
      "rates in rad/s, or check the axes",
      gyro_rate_rad_s / kDegree, rate_rad_s / kDegree);
  if (rate_rad_s < kMinRotationRate_rad_s)
    return is_too_fast ? std::optional(too_fast) : std::nullopt;
  if (measured.gg.trace() < kMinEnergyRatio * measured.pp) {
    return fmt::format("the images rotate at {:.1f} deg/s, the gyroscope measures no rotation",
                       rate_rad_s / kDegree);
  }
  // two readings in each interval: else the error of the interpolation resembles an offset
  const double reading_interval_s = median_interval_s(gyro.stamps).value_or(HUGE_VAL);
  const bool resolves_offset = 2 * reading_interval_s <= kMinRotationInterval_s;
  const ClockOffset clock =
      resolves_offset ? clock_offset(sum, intervals, kMinPairs) : ClockOffset{};
  Hypothesis best{clock.explained, clock_description(clock)};
  if (measured.explained_fraction(Matrix3d::Identity()) > kConsistentFraction) {
    const double offset_s = std::abs(clock.offset_s);
    if (offset_s < kMinOffset_s || offset_s < kMinOffsetSigmas * clock.sigma_s) return std::nullopt;
  } else {
    const Matrix3d axes = best_axes(measured);
    const Hypothesis degrees{measured.explained_fraction(Matrix3d::Identity(), kDegree),
                             "a gyroscope in deg/s instead of rad/s"};
    const Hypothesis rotated_axes{measured.explained_fraction(axes), axes_description(axes)};
    best = std::max({degrees, rotated_axes, best},
                    [](const auto& a, const auto& b) { return a.explained < b.explained; });
  }
  if (best.explained < kMinExplainedFraction) {
    return is_too_fast ? std::optional(too_fast) : std::nullopt;
  }
  return fmt::format(
      "gyroscope and image rotations disagree; {} would explain {:.0f} % of the image rotation",
      best.description, 100 * best.explained);
}

}  // namespace stillkite
