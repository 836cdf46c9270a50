#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "estimation/two_view/relative_pose.hpp"

namespace stillkite {

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// Standard deviation over median |x| of a zero-mean normal x.
inline constexpr double kMadToSigma = 1.4826022185056018;

/// E = [t]x R (hold paper, eq. 2).
[[nodiscard]] Eigen::Matrix3d essential_matrix(const RelativePose& pose);

/// Signed Sampson error on z = 1: e = b^T E a / sqrt(|E a|^2 + |E^T b|^2), norms of the first two
/// components. Its standard deviation is that of one coordinate of either point. Hartley and
/// Zisserman 2004, eq. (11.9).
[[nodiscard]] double sampson_error(const Eigen::Matrix3d& E, const BearingPair& pair);

/// Bearing pairs as a structure of arrays, in random order: any block is an unbiased sample.
class BearingColumns {
 public:
  static constexpr std::size_t kPadding = 8;

  BearingColumns(std::span<const BearingPair> pairs, std::span<const int> order);
  /// Subset of `all` by index.
  BearingColumns(const BearingColumns& all, std::span<const std::size_t> indices);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t padded() const { return weight.size(); }

  std::vector<double> ax, ay, bx, by;  ///< reference (ax, ay), current (bx, by)
  std::vector<double> weight;          ///< 1, or 0 in the padding
  std::vector<float> fax, fay, fbx, fby, fweight;

 private:
  std::size_t size_;
};

/// Sums of one iteratively reweighted least-squares step over the nine entries of E, row by row.
/// Tukey weights w = (1 - u)^2 with u = e^2 / cutoff^2; g = de/dE.
struct SampsonSums {
  Matrix9d normal = Matrix9d::Zero();    ///< sum w g g^T
  Vector9d gradient = Vector9d::Zero();  ///< sum w e g
  double squared_influence = 0;          ///< sum (w e)^2
  double slope = 0;                      ///< sum of d(w e)/de
  double weight = 0;                     ///< sum w
  double count = 0;                      ///< pairs within the cutoff
};
[[nodiscard]] SampsonSums sampson_sums(const BearingColumns& columns, const Eigen::Matrix3d& E,
                                       double cutoff);

/// MSAC cost: sum of min(e^2 / threshold^2, 1). Stops early with a value above `cost_limit` if the
/// extrapolated partial sum exceeds that limit by four standard deviations.
[[nodiscard]] double truncated_cost(const BearingColumns& columns, const Eigen::Matrix3d& E,
                                    double threshold, double cost_limit);

/// |e| of each pair, in the order of the columns.
[[nodiscard]] std::vector<float> sampson_distances(const BearingColumns& columns,
                                                   const Eigen::Matrix3d& E);

}  // namespace stillkite
