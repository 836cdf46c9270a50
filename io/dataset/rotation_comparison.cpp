#include "io/dataset/rotation_comparison.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

namespace stillkite {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

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

}  // namespace

GyroIntegral::GyroIntegral(const TimeSeries<Vector3d>& gyro)
    : stamps_(gyro.stamps), max_gap_s_(gyro.max_gap_s), at_(stamps_.size(), {Vector3d::Zero(), 0}) {
  for (std::size_t i = 1; i < stamps_.size(); ++i) {
    const double dt_s = seconds_between(stamps_[i - 1], stamps_[i]);
    const bool is_gap = dt_s > gyro.max_gap_s;
    at_[i] = {at_[i - 1].rotation_rad + 0.5 * dt_s * (gyro.values[i - 1] + gyro.values[i]),
              at_[i - 1].gaps + (is_gap ? 1 : 0)};
  }
}

std::optional<Vector3d> GyroIntegral::between(Timestamp from, Timestamp to) const {
  const std::optional<Sum> first = at(from), last = at(to);
  if (!first || !last || first->gaps != last->gaps) return std::nullopt;
  return Vector3d(last->rotation_rad - first->rotation_rad);
}

std::optional<GyroIntegral::Sum> GyroIntegral::at(Timestamp stamp) const {
  const auto after = std::lower_bound(stamps_.begin(), stamps_.end(), stamp);
  if (after == stamps_.end() || after == stamps_.begin()) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - stamps_.begin());
  const double interval_s = seconds_between(stamps_[i - 1], stamps_[i]);
  if (interval_s > max_gap_s_ && stamp != stamps_[i]) return std::nullopt;
  const double ratio = seconds_between(stamps_[i - 1], stamp) / interval_s;
  return Sum{at_[i - 1].rotation_rad + ratio * (at_[i].rotation_rad - at_[i - 1].rotation_rad),
             at_[i].gaps};
}

std::vector<ObservedRotation> merged_rotations(std::span<const ObservedRotation> observed) {
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
    if (seconds_between(sum->from, sum->to) < kMinRotationInterval_s) continue;
    out.push_back(*sum);
    sum.reset();
  }
  return out;
}

double RotationSums::explained_fraction(const Matrix3d& M, double scale) const {
  return (2 * scale * (M.transpose() * pg).trace() - scale * scale * gg.trace()) / pp;
}

double RotationSums::best_scale(const Matrix3d& M) const {
  return (M.transpose() * pg).trace() / gg.trace();
}

double RotationSums::explained_at_best_scale(const Matrix3d& M) const {
  const double scale = best_scale(M);
  return scale > 0 ? explained_fraction(M, scale) : 0;
}

double RotationSums::image_rate_rad_s() const {
  return std::sqrt(pp / count) * count / time_s;
}

double RotationSums::gyro_rate_rad_s() const {
  return std::sqrt(gg.trace() / count) * count / time_s;
}

RotationSums rotation_sums(const GyroIntegral& gyro, std::span<const ObservedRotation> intervals,
                           double offset_s) {
  const std::int64_t offset_ns = std::llround(1e9 * offset_s);
  RotationSums out;
  Vector3d p_sum = Vector3d::Zero(), g_sum = Vector3d::Zero();
  Vector3d pt_sum = Vector3d::Zero(), gt_sum = Vector3d::Zero();
  double tt_sum = 0;
  for (const ObservedRotation& rotation : intervals) {
    const double dt_s = seconds_between(rotation.from, rotation.to);
    const Vector3d& p = rotation.rotation_in_body_rad;
    const auto g = gyro.between({rotation.from.ns + offset_ns}, {rotation.to.ns + offset_ns});
    if (!g) continue;
    out.pg += p * g->transpose();
    out.pp += p.squaredNorm();
    out.gg += *g * g->transpose();
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
  out.gg += tt_sum * G * G.transpose() - G * gt_sum.transpose() - gt_sum * G.transpose();
  out.bias_rad_s = G - P;
  return out;
}

Matrix3d best_axes(const RotationSums& sums) {
  const Eigen::JacobiSVD<Matrix3d> svd(sums.pg, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Matrix3d best_rotation(const RotationSums& sums) {
  const Eigen::JacobiSVD<Matrix3d> svd(sums.pg, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d VT = svd.matrixV().transpose();
  const double handedness = (svd.matrixU() * VT).determinant();
  return svd.matrixU() * Vector3d(1, 1, handedness < 0 ? -1 : 1).asDiagonal() * VT;
}

ClockOffset clock_offset(const GyroIntegral& gyro, std::span<const ObservedRotation> intervals,
                         int min_pairs, const OffsetSearch& search) {
  constexpr double kStep_s = 0.02, kMinGain = 0.02;
  const int max_steps = static_cast<int>(search.range_s / kStep_s);
  const auto at_step = [&](double step) { return search.centre_s + kStep_s * step; };
  const auto explained_by = [&](const RotationSums& sums) {
    return search.any_axes ? sums.explained_at_best_scale(best_axes(sums))
                           : sums.explained_fraction(Matrix3d::Identity());
  };
  const auto explained_at = [&](int step) {
    const RotationSums sums = rotation_sums(gyro, intervals, at_step(step));
    return sums.count < min_pairs ? -1.0 : explained_by(sums);
  };
  int best = 0;
  double explained = explained_at(0);
  for (int i = 1; i <= max_steps; ++i) {
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
  const std::vector<ObservedRotation> same =
      covered(gyro, intervals, std::array{at_step(best - 1), at_step(best), at_step(best + 1)});
  if (same.empty()) return {};
  const auto fraction = [&](int step) {
    return explained_by(rotation_sums(gyro, same, at_step(step)));
  };
  before = fraction(best - 1);
  explained = fraction(best);
  after = fraction(best + 1);
  const double curvature = std::max(2 * explained - before - after, 1e-12);
  const double shift = 0.5 * (after - before) / curvature;
  const auto count = static_cast<double>(same.size());
  return {
      .offset_s = at_step(best + shift),
      .sigma_s = kStep_s * std::sqrt(2 * std::max(0.0, 1 - explained) / (3 * count * curvature)),
      .explained = explained};
}

}  // namespace stillkite
