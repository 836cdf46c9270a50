#include "io/dataset/gyro_check.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry/angle.hpp"

namespace stillkite {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Integral of the angular rate over the log, linear between readings.
class GyroIntegral {
 public:
  explicit GyroIntegral(const TimeSeries<Vector3d>& gyro)
      : stamps_(gyro.stamps),
        max_gap_s_(gyro.max_gap_s),
        at_(stamps_.size(), {Vector3d::Zero(), 0}) {
    for (std::size_t i = 1; i < stamps_.size(); ++i) {
      const double dt_s = seconds_between(stamps_[i - 1], stamps_[i]);
      const bool is_gap = dt_s > gyro.max_gap_s;
      at_[i] = {at_[i - 1].rotation_rad + 0.5 * dt_s * (gyro.values[i - 1] + gyro.values[i]),
                at_[i - 1].gaps + (is_gap ? 1 : 0)};
    }
  }

  // Nullopt outside the log and over its gaps.
  [[nodiscard]] std::optional<Vector3d> between(Timestamp from, Timestamp to) const {
    const std::optional<Sum> first = at(from), last = at(to);
    if (!first || !last || first->gaps != last->gaps) return std::nullopt;
    return Vector3d(last->rotation_rad - first->rotation_rad);
  }

 private:
  struct Sum {
    Vector3d rotation_rad;
    int gaps = 0;
  };

  [[nodiscard]] std::optional<Sum> at(Timestamp stamp) const {
    const auto after = std::lower_bound(stamps_.begin(), stamps_.end(), stamp);
    if (after == stamps_.end() || after == stamps_.begin()) return std::nullopt;
    const auto i = static_cast<std::size_t>(after - stamps_.begin());
    const double interval_s = seconds_between(stamps_[i - 1], stamps_[i]);
    if (interval_s > max_gap_s_ && stamp != stamps_[i]) return std::nullopt;
    const double ratio = seconds_between(stamps_[i - 1], stamp) / interval_s;
    return Sum{at_[i - 1].rotation_rad + ratio * (at_[i].rotation_rad - at_[i - 1].rotation_rad),
               at_[i].gaps};
  }

  const std::vector<Timestamp>& stamps_;
  double max_gap_s_;
  std::vector<Sum> at_;
};

constexpr double kMinInterval_s = 0.1;

// Adds up consecutive image rotations to at least kMinInterval_s: at 240 frames per second the
// noise of one frame exceeds its rotation.
std::vector<ObservedRotation> merged(std::span<const ObservedRotation> observed) {
  constexpr double kMaxRate_rad_s = 5;  // larger image rotations are outliers
  std::vector<ObservedRotation> out;
  std::optional<ObservedRotation> sum;
  for (const ObservedRotation& rotation : observed) {
    const double dt_s = seconds_between(rotation.from, rotation.to);
    if (!(rotation.rotation_in_body_rad.norm() < kMaxRate_rad_s * dt_s)) {
      sum.reset();
      continue;
    }
    if (sum && sum->to == rotation.from) {
      sum->to = rotation.to;
      sum->rotation_in_body_rad += rotation.rotation_in_body_rad;
    } else {
      sum = rotation;
    }
    if (seconds_between(sum->from, sum->to) < kMinInterval_s) continue;
    out.push_back(*sum);
    sum.reset();
  }
  return out;
}

// Sums over intervals of image rotations p and gyroscope rotations g, both less their mean rate:
// that of the gyroscope includes its bias.
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
  const std::int64_t offset_ns = std::llround(1e9 * offset_s);
  RotationSums out;
  Vector3d p_sum = Vector3d::Zero(), g_sum = Vector3d::Zero();
  Vector3d pt_sum = Vector3d::Zero(), gt_sum = Vector3d::Zero();
  double tt_sum = 0;
  for (const ObservedRotation& rotation : observed) {
    const double dt_s = seconds_between(rotation.from, rotation.to);
    const Vector3d& p = rotation.rotation_in_body_rad;
    const auto g = gyro.between({rotation.from.ns + offset_ns}, {rotation.to.ns + offset_ns});
    if (!g) continue;
    out.pg += p * g->transpose();
    out.pp += p.squaredNorm();
    out.gg += g->squaredNorm();
    p_sum += p;
    g_sum += *g;
    pt_sum += dt_s * p;
    gt_sum += dt_s * *g;
    tt_sum += dt_s * dt_s;
    out.time_s += dt_s;
    ++out.count;
  }
  if (out.count == 0) return out;
  // sum (p - P dt)(g - G dt)^T with the mean rates P, G
  const Vector3d P = p_sum / out.time_s, G = g_sum / out.time_s;
  out.pg += tt_sum * P * G.transpose() - P * gt_sum.transpose() - pt_sum * G.transpose();
  out.pp += tt_sum * P.squaredNorm() - 2 * P.dot(pt_sum);
  out.gg += tt_sum * G.squaredNorm() - 2 * G.dot(gt_sum);
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
  return fmt::format(
      "gyroscope axes rotated by {:.0f} deg about ({:.1f}, {:.1f}, {:.1f}) (set "
      "rotation_wxyz, body from sensor)",
      rotation.angle() / kDegree, rotation.axis().x(), rotation.axis().y(), rotation.axis().z());
}

struct Hypothesis {
  double explained = 0;
  std::string description;
};

struct ClockOffset {
  double offset_s = 0;  // of the log ahead of the images
  double sigma_s = 0;
  double explained = 0;
};

// Intervals that the log covers at each of the offsets, so that their sums are comparable.
std::vector<ObservedRotation> covered(const GyroIntegral& gyro,
                                      std::span<const ObservedRotation> observed,
                                      std::span<const double> offsets_s) {
  std::vector<ObservedRotation> out;
  for (const ObservedRotation& rotation : observed) {
    const bool is_covered = std::ranges::all_of(offsets_s, [&](double offset_s) {
      const std::int64_t ns = std::llround(1e9 * offset_s);
      return gyro.between({rotation.from.ns + ns}, {rotation.to.ns + ns}).has_value();
    });
    if (is_covered) out.push_back(rotation);
  }
  return out;
}

// Least squares over offsets within 5 s. Of several that explain a periodic motion, the smallest.
ClockOffset clock_offset(const GyroIntegral& gyro, std::span<const ObservedRotation> observed,
                         int min_pairs) {
  constexpr int kMaxSteps = 250;
  constexpr double kStep_s = 0.02, kMinGain = 0.02;
  const auto explained_at = [&](int step) {
    const RotationSums sums = rotation_sums(gyro, observed, kStep_s * step);
    return sums.count < min_pairs ? -1.0 : sums.explained_fraction(Matrix3d::Identity());
  };
  int best = 0;
  double explained = explained_at(0);
  for (int i = 1; i <= kMaxSteps; ++i) {
    for (const int step : {i, -i}) {
      if (const double value = explained_at(step); value > explained + kMinGain) {
        best = step;
        explained = value;
      }
    }
  }
  double before = explained_at(best - 1), after = explained_at(best + 1);
  while (std::max(before, after) > explained) {
    const int direction = after > before ? 1 : -1;
    best += direction;
    (direction > 0 ? before : after) = explained;
    explained = direction > 0 ? after : before;
    (direction > 0 ? after : before) = explained_at(best + direction);
  }
  // parabola through three steps; sigma by the residual of 3 components per interval
  const std::vector<ObservedRotation> same = covered(
      gyro, observed, std::array{kStep_s * (best - 1), kStep_s * best, kStep_s * (best + 1)});
  if (same.empty()) return {};
  const auto fraction = [&](int step) {
    return rotation_sums(gyro, same, kStep_s * step).explained_fraction(Matrix3d::Identity());
  };
  before = fraction(best - 1);
  explained = fraction(best);
  after = fraction(best + 1);
  const double curvature = std::max(2 * explained - before - after, 1e-12);
  const double shift = 0.5 * (after - before) / curvature;
  const auto count = static_cast<double>(same.size());
  return {
      .offset_s = kStep_s * (best + shift),
      .sigma_s = kStep_s * std::sqrt(2 * std::max(0.0, 1 - explained) / (3 * count * curvature)),
      .explained = explained};
}

std::string clock_description(const ClockOffset& clock) {
  return fmt::format(
      "a gyroscope clock {:.2f} s {} (add {:+.3f} to time_offset_s)", std::abs(clock.offset_s),
      clock.offset_s > 0 ? "ahead of the images" : "behind the images", -clock.offset_s);
}

}  // namespace

std::optional<std::string> gyro_inconsistency(const TimeSeries<Vector3d>& gyro,
                                              std::span<const ObservedRotation> observed) {
  constexpr int kMinPairs = 10;  // 1 s at least
  constexpr double kMinRate_rad_s = 0.5 * kDegree;
  constexpr double kConsistentFraction = 0.5, kMinExplainedFraction = 0.6, kMinEnergyRatio = 0.01;
  constexpr double kMaxRateRatio = 10, kMinFast_rad_s = 20 * kDegree;
  constexpr double kMinOffset_s = 0.015, kMinOffsetSigmas = 6;
  const GyroIntegral sum(gyro);
  const std::vector<ObservedRotation> intervals = merged(observed);
  const RotationSums measured = rotation_sums(sum, intervals, 0);
  if (measured.count < kMinPairs) return std::nullopt;
  const double mean_dt_s = measured.time_s / measured.count;
  const double rate_rad_s = std::sqrt(measured.pp / measured.count) / mean_dt_s;
  const double gyro_rate_rad_s = std::sqrt(measured.gg / measured.count) / mean_dt_s;
  const double rate_ratio = gyro_rate_rad_s / std::max(rate_rad_s, kMinRate_rad_s);
  const bool is_too_fast = rate_ratio > kMaxRateRatio && gyro_rate_rad_s > kMinFast_rad_s;
  const std::string too_fast = fmt::format(
      "the gyroscope measures {:.0f} deg/s, the images rotate at {:.1f} deg/s; give the angular "
      "rates in rad/s, or check the axes",
      gyro_rate_rad_s / kDegree, rate_rad_s / kDegree);
  if (rate_rad_s < kMinRate_rad_s) return is_too_fast ? std::optional(too_fast) : std::nullopt;
  if (measured.gg < kMinEnergyRatio * measured.pp) {
    return fmt::format("the images rotate at {:.1f} deg/s, the gyroscope measures no rotation",
                       rate_rad_s / kDegree);
  }
  // two readings in each interval: else the error of the interpolation resembles an offset
  const double reading_interval_s = median_interval_s(gyro.stamps).value_or(HUGE_VAL);
  const bool resolves_offset = 2 * reading_interval_s <= kMinInterval_s;
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
