#include "io/dataset/gyro_check.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Integral of the angular rate over the log, interpolated between readings.
class GyroIntegral {
 public:
  explicit GyroIntegral(const TimeSeries<Vector3d>& gyro)
      : stamps_(gyro.stamps), integrals_rad_(stamps_.size(), Vector3d::Zero()) {
    for (std::size_t i = 1; i < stamps_.size(); ++i) {
      integrals_rad_[i] =
          integrals_rad_[i - 1] + seconds_between(stamps_[i - 1], stamps_[i]) * gyro.values[i];
    }
  }

  // Nullopt outside the log.
  [[nodiscard]] std::optional<Vector3d> at(Timestamp stamp) const {
    const auto after = std::lower_bound(stamps_.begin(), stamps_.end(), stamp);
    if (after == stamps_.end() || after == stamps_.begin()) return std::nullopt;
    const auto i = static_cast<std::size_t>(after - stamps_.begin());
    const double ratio =
        seconds_between(stamps_[i - 1], stamp) / seconds_between(stamps_[i - 1], stamps_[i]);
    return Vector3d(integrals_rad_[i - 1] + ratio * (integrals_rad_[i] - integrals_rad_[i - 1]));
  }

 private:
  const std::vector<Timestamp>& stamps_;
  std::vector<Vector3d> integrals_rad_;
};

// Sums over frame intervals of image rotations p and gyroscope rotations g.
struct RotationSums {
  Matrix3d pg = Matrix3d::Zero();  // sum of p g^T
  double pp = 0;                   // sum of |p|^2
  double gg = 0;                   // sum of |g|^2
  double time_s = 0;
  int count = 0;

  // 1 - sum |p - s M g|^2 / sum |p|^2, with orthogonal M and scale s.
  [[nodiscard]] double explained_fraction(const Matrix3d& M, double scale = 1) const {
    return (2 * scale * (M.transpose() * pg).trace() - scale * scale * gg) / pp;
  }
};

RotationSums rotation_sums(const GyroIntegral& gyro, std::span<const ObservedRotation> observed,
                           double offset_s) {
  constexpr double kMaxRate_rad_s = 5;  // larger image rotations are outliers
  const std::int64_t offset_ns = std::llround(1e9 * offset_s);
  RotationSums out;
  for (const ObservedRotation& rotation : observed) {
    const double dt_s = seconds_between(rotation.from, rotation.to);
    const auto from = gyro.at({rotation.from.ns + offset_ns});
    const auto to = gyro.at({rotation.to.ns + offset_ns});
    if (!from || !to || !(rotation.rotation_in_body_rad.norm() < kMaxRate_rad_s * dt_s)) continue;
    const Vector3d gyro_rad = *to - *from;
    out.pg += rotation.rotation_in_body_rad * gyro_rad.transpose();
    out.pp += rotation.rotation_in_body_rad.squaredNorm();
    out.gg += gyro_rad.squaredNorm();
    out.time_s += dt_s;
    ++out.count;
  }
  return out;
}

// Orthogonal M that minimizes sum |p - M g|^2 (Schönemann 1966).
Matrix3d best_axes(const RotationSums& sums) {
  const Eigen::JacobiSVD<Matrix3d> svd(sums.pg, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

std::string axes_description(const Matrix3d& axes) {
  if (axes.determinant() < 0) return "one or all gyroscope axes inverted";
  const Eigen::AngleAxisd rotation(axes);
  return fmt::format("gyroscope axes rotated by {:.0f} deg about ({:.1f}, {:.1f}, {:.1f})",
                     rotation.angle() / kDegree, rotation.axis().x(), rotation.axis().y(),
                     rotation.axis().z());
}

struct Hypothesis {
  double explained = 0;
  std::string description;
};

Hypothesis clock_offset_hypothesis(const GyroIntegral& gyro,
                                   std::span<const ObservedRotation> observed, int min_pairs) {
  constexpr double kMaxOffset_s = 5, kStep_s = 0.02;
  Hypothesis best;
  for (double offset_s = -kMaxOffset_s; offset_s <= kMaxOffset_s; offset_s += kStep_s) {
    const RotationSums sums = rotation_sums(gyro, observed, offset_s);
    if (sums.count < min_pairs) continue;
    const double explained = sums.explained_fraction(Matrix3d::Identity());
    if (explained > best.explained) {
      best = {explained, fmt::format("a gyroscope clock {:.2f} s {}", std::abs(offset_s),
                                     offset_s > 0 ? "ahead of the images" : "behind the images")};
    }
  }
  return best;
}

}  // namespace

std::optional<std::string> gyro_inconsistency(const TimeSeries<Vector3d>& gyro,
                                              std::span<const ObservedRotation> observed) {
  constexpr int kMinPairs = 50;
  constexpr double kMinRate_rad_s = 1 * kDegree;
  constexpr double kConsistentFraction = 0.5, kMinExplainedFraction = 0.6, kMinEnergyRatio = 0.01;
  const GyroIntegral sum(gyro);
  const RotationSums measured = rotation_sums(sum, observed, 0);
  if (measured.count < kMinPairs) return std::nullopt;
  const double mean_dt_s = measured.time_s / measured.count;
  const double rate_rad_s = std::sqrt(measured.pp / measured.count) / mean_dt_s;
  const double explained = measured.explained_fraction(Matrix3d::Identity());
  if (rate_rad_s < kMinRate_rad_s || explained > kConsistentFraction) return std::nullopt;
  if (measured.gg < kMinEnergyRatio * measured.pp) {
    return fmt::format("the images rotate at {:.1f} deg/s, the gyroscope measures no rotation",
                       rate_rad_s / kDegree);
  }
  const Matrix3d axes = best_axes(measured);
  const Hypothesis degrees{measured.explained_fraction(Matrix3d::Identity(), kDegree),
                           "a gyroscope in deg/s instead of rad/s"};
  const Hypothesis rotated_axes{measured.explained_fraction(axes), axes_description(axes)};
  const Hypothesis clock = clock_offset_hypothesis(sum, observed, kMinPairs);
  const Hypothesis& best =
      std::max({degrees, rotated_axes, clock},
               [](const auto& a, const auto& b) { return a.explained < b.explained; });
  if (best.explained < kMinExplainedFraction) return std::nullopt;
  return fmt::format(
      "gyroscope and image rotations disagree; {} would explain {:.0f} % of the image rotation",
      best.description, 100 * best.explained);
}

}  // namespace stillkite
