#include "io/setup/axes_comparison.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "io/setup/block_statistics.hpp"

namespace stillkite {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

// Scale of least squares, not negative.
double scale_of(std::span<const RotationPair> pairs, const Matrix3d& axes) {
  double pg = 0, gg = 0;
  for (const RotationPair& pair : pairs) {
    pg += pair.images.dot(axes * pair.gyro);
    gg += pair.gyro.squaredNorm();
  }
  return std::max(pg / gg, 0.0);
}

}  // namespace

std::vector<RotationPair> rotation_pairs(const GyroIntegral& gyro,
                                         std::span<const ObservedRotation> intervals,
                                         double offset_s) {
  const std::int64_t offset_ns = std::llround(1e9 * offset_s);
  std::vector<RotationPair> out;
  std::vector<double> dts_s;
  Vector3d images = Vector3d::Zero(), rates = Vector3d::Zero();
  double time_s = 0;
  for (const ObservedRotation& rotation : intervals) {
    const auto g = gyro.between({rotation.from.ns + offset_ns}, {rotation.to.ns + offset_ns});
    if (!g) continue;
    out.push_back({rotation.rotation_in_body_rad, *g});
    dts_s.push_back(seconds_between(rotation.from, rotation.to));
    images += rotation.rotation_in_body_rad;
    rates += *g;
    time_s += dts_s.back();
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].images -= dts_s[i] / time_s * images;
    out[i].gyro -= dts_s[i] / time_s * rates;
  }
  return out;
}

AxesGain axes_gain(std::span<const RotationPair> pairs, const Matrix3d& better,
                   const Matrix3d& worse) {
  const Matrix3d scaled_better = scale_of(pairs, better) * better;
  const Matrix3d scaled_worse = scale_of(pairs, worse) * worse;
  double better2 = 0, worse2 = 0;
  for (const RotationPair& pair : pairs) {
    better2 += (pair.images - scaled_better * pair.gyro).squaredNorm();
    worse2 += (pair.images - scaled_worse * pair.gyro).squaredNorm();
  }
  const BlockEstimate by_blocks = block_jackknife(pairs.size(), [&](const auto& excluded) {
    double difference = 0, whole = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (excluded(i)) continue;
      difference += (pairs[i].images - scaled_worse * pairs[i].gyro).squaredNorm() -
                    (pairs[i].images - scaled_better * pairs[i].gyro).squaredNorm();
      whole += pairs[i].images.squaredNorm();
    }
    return difference / whole;
  });
  constexpr double kSigmaOfLogarithm = 0.365;  // sqrt(4 / (3 kBlocks))
  return {by_blocks.value, std::max(by_blocks.value / std::max(by_blocks.sigma, 1e-9),
                                    std::log(worse2 / better2) / kSigmaOfLogarithm)};
}

bool is_better(std::span<const RotationPair> pairs, const Matrix3d& better, const Matrix3d& worse) {
  return axes_gain(pairs, better, worse).is_significant();
}

bool rotates_about_two_axes(const RotationSums& sums) {
  constexpr double kMinRatio = 0.02;
  const Vector3d energies = Eigen::SelfAdjointEigenSolver<Matrix3d>(sums.gg).eigenvalues();
  return energies(1) > kMinRatio * energies(2);
}

std::span<const Matrix3d> signed_permutations() {
  static const std::vector<Matrix3d> all = [] {
    std::vector<Matrix3d> out;
    std::array<int, 3> order{0, 1, 2};
    do {
      for (int signs = 0; signs < 8; ++signs) {
        Matrix3d axes = Matrix3d::Zero();
        for (int row = 0; row < 3; ++row) {
          axes(row, order[static_cast<std::size_t>(row)]) = (signs >> row & 1) != 0 ? -1 : 1;
        }
        out.push_back(axes);
      }
    } while (std::ranges::next_permutation(order).found);
    return out;
  }();
  return all;
}

}  // namespace stillkite
