#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "estimation/two_view/relative_pose.hpp"

namespace stillkite {

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// From the median of |x| to the standard deviation of a normal x.
inline constexpr double kSigmaOfMedian = 1.4826022185056018;

/// E = [t]x R: hold paper, eq. (2).
[[nodiscard]] Eigen::Matrix3d essential_matrix(const RelativePose& pose);

/// First-order distance of a pair to the epipolar constraint, signed, on z = 1:
/// e = b^T E a / sqrt(|E a|^2 + |E^T b|^2), the norms over the first two components. Its standard
/// deviation is that of a coordinate of either point. Hartley and Zisserman 2004, eq. (11.9).
[[nodiscard]] double sampson_error(const Eigen::Matrix3d& E, const BearingPair& pair);

/// Pairs by column, in a random order so that any stretch of them is a fair sample.
class BearingColumns {
 public:
  static constexpr std::size_t kPadding = 8;

  BearingColumns(std::span<const BearingPair> pairs, std::span<const int> order);
  /// Some of them, by their places.
  BearingColumns(const BearingColumns& all, std::span<const std::size_t> some);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t padded() const { return weight.size(); }

  std::vector<double> ax, ay, bx, by;  ///< reference (ax, ay), current (bx, by)
  std::vector<double> weight;          ///< 1, or 0 in the padding
  std::vector<float> fax, fay, fbx, fby, fweight;

 private:
  std::size_t size_;
};

/// What a step of iteratively reweighted least squares over E needs, with Tukey's weights w = (1 -
/// u)^2 of u = e^2 / cutoff^2 and g = de/dE, row by row.
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

/// Sum of min(e^2 / threshold^2, 1), one an outlier. Gives up, with a sum over `worst`, as soon as
/// what has been seen makes it unlikely (four standard deviations) that the sum stays below it.
[[nodiscard]] double truncated_cost(const BearingColumns& columns, const Eigen::Matrix3d& E,
                                    double threshold, double worst);

/// |e| of each pair, in the order of the columns.
[[nodiscard]] std::vector<float> sampson_distances(const BearingColumns& columns,
                                                   const Eigen::Matrix3d& E);

}  // namespace stillkite
