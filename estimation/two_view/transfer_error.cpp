#include "estimation/two_view/transfer_error.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimation/two_view/transfer_error.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// One SIMD vector of pairs: (rx, ry) = pi(H a) - b, S = (I + A A^T)^-1, p = S r.
template <class D>
struct Transfer {
  using V = hn::Vec<D>;
  V x, y, inverse_depth, sxx, sxy, syy, px, py, squared;

  Transfer(D d, const std::array<V, 9>& H, V ax, V ay, V bx, V by) {
    using T = hn::TFromD<D>;
    const V one = hn::Set(d, T{1});
    const V depth = hn::MulAdd(H[6], ax, hn::MulAdd(H[7], ay, H[8]));
    const auto in_front = hn::Gt(depth, hn::Set(d, T(1e-6)));
    inverse_depth = hn::Div(one, hn::IfThenElse(in_front, depth, one));
    x = hn::Mul(inverse_depth, hn::MulAdd(H[0], ax, hn::MulAdd(H[1], ay, H[2])));
    y = hn::Mul(inverse_depth, hn::MulAdd(H[3], ax, hn::MulAdd(H[4], ay, H[5])));
    const V rx = hn::Sub(x, bx), ry = hn::Sub(y, by);
    const V a00 = hn::Mul(inverse_depth, hn::NegMulAdd(x, H[6], H[0]));
    const V a01 = hn::Mul(inverse_depth, hn::NegMulAdd(x, H[7], H[1]));
    const V a10 = hn::Mul(inverse_depth, hn::NegMulAdd(y, H[6], H[3]));
    const V a11 = hn::Mul(inverse_depth, hn::NegMulAdd(y, H[7], H[4]));
    const V cxx = hn::MulAdd(a00, a00, hn::MulAdd(a01, a01, one));
    const V cyy = hn::MulAdd(a10, a10, hn::MulAdd(a11, a11, one));
    const V cxy = hn::MulAdd(a00, a10, hn::Mul(a01, a11));
    const V inverse = hn::Div(one, hn::NegMulAdd(cxy, cxy, hn::Mul(cxx, cyy)));
    sxx = hn::Mul(cyy, inverse);
    syy = hn::Mul(cxx, inverse);
    sxy = hn::Neg(hn::Mul(cxy, inverse));
    px = hn::MulAdd(sxx, rx, hn::Mul(sxy, ry));
    py = hn::MulAdd(sxy, rx, hn::Mul(syy, ry));
    squared = hn::IfThenElse(in_front, hn::MulAdd(px, rx, hn::Mul(py, ry)), hn::Set(d, T(1e20)));
  }
};

using TransferFloats = hn::CappedTag<float, BearingColumns::kPadding>;
using TransferDoubles = hn::CappedTag<double, BearingColumns::kPadding>;

template <class D>
std::array<hn::Vec<D>, 9> broadcast_homography(D d, const double* H) {
  std::array<hn::Vec<D>, 9> v;
  for (std::size_t k = 0; k < 9; ++k) v[k] = hn::Set(d, static_cast<hn::TFromD<D>>(H[k]));
  return v;
}

void transfer_distances_kernel(const BearingColumns& c, std::size_t begin, std::size_t end,
                               const double* H, float* out) {
  const TransferFloats d;
  const std::array<hn::Vec<TransferFloats>, 9> h = broadcast_homography(d, H);
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    const Transfer<TransferFloats> at(d, h, hn::LoadU(d, &c.fax[i]), hn::LoadU(d, &c.fay[i]),
                                      hn::LoadU(d, &c.fbx[i]), hn::LoadU(d, &c.fby[i]));
    hn::StoreU(hn::Sqrt(hn::Max(at.squared, hn::Zero(d))), d, out + (i - begin));
  }
}

// TransferSums: 36 entries of the normal matrix, 9 of the gradient, 4 sums.
void transfer_sums_kernel(const BearingColumns& c, const double* H, double inverse_squared_cutoff,
                          std::array<double, 49>& out) {
  const TransferDoubles d;
  using V = hn::Vec<TransferDoubles>;
  const std::array<V, 9> h = broadcast_homography(d, H);
  const V scale = hn::Set(d, inverse_squared_cutoff);
  const V one = hn::Set(d, 1.0), three = hn::Set(d, 3.0), zero = hn::Zero(d);
  std::array<V, 49> sum;
  sum.fill(zero);
  for (std::size_t i = 0; i < c.padded(); i += hn::Lanes(d)) {
    const V ax = hn::LoadU(d, &c.ax[i]), ay = hn::LoadU(d, &c.ay[i]);
    const Transfer<TransferDoubles> at(d, h, ax, ay, hn::LoadU(d, &c.bx[i]),
                                       hn::LoadU(d, &c.by[i]));
    const V u = hn::Mul(at.squared, scale);
    const V root_weight = hn::Mul(hn::Max(hn::Sub(one, u), zero), hn::LoadU(d, &c.weight[i]));
    const V w = hn::Mul(root_weight, root_weight);
    const V f = hn::Mul(w, at.inverse_depth);
    const V ff = hn::Mul(f, at.inverse_depth);
    // P^T S P with P = [I | -(x, y)]
    const V m02 = hn::Neg(hn::MulAdd(at.sxx, at.x, hn::Mul(at.sxy, at.y)));
    const V m12 = hn::Neg(hn::MulAdd(at.sxy, at.x, hn::Mul(at.syy, at.y)));
    const V m22 = hn::Neg(hn::MulAdd(m02, at.x, hn::Mul(m12, at.y)));
    const std::array<V, 6> M{at.sxx, at.sxy, m02, at.syy, m12, m22};
    const std::array<V, 6> aa{hn::Mul(ax, ax), hn::Mul(ax, ay), ax, hn::Mul(ay, ay), ay, one};
    std::size_t k = 0;
    for (const V& m : M) {
      const V fm = hn::Mul(ff, m);
      for (const V& product : aa) {
        sum[k] = hn::MulAdd(fm, product, sum[k]);
        ++k;
      }
    }
    const V pz = hn::Neg(hn::MulAdd(at.px, at.x, hn::Mul(at.py, at.y)));
    for (const V& p : {at.px, at.py, pz}) {
      const V fp = hn::Mul(f, p);
      for (const V& a : {ax, ay, one}) {
        sum[k] = hn::MulAdd(fp, a, sum[k]);
        ++k;
      }
    }
    sum[45] = hn::MulAdd(hn::Mul(w, w), at.squared, sum[45]);
    sum[46] = hn::MulAdd(root_weight, hn::NegMulAdd(three, u, one), sum[46]);
    sum[47] = hn::Add(sum[47], w);
    sum[48] = hn::Add(sum[48], hn::IfThenElseZero(hn::Gt(root_weight, zero), one));
  }
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = hn::GetLane(hn::SumOfLanes(d, sum[k]));
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(transfer_distances_kernel);
HWY_EXPORT(transfer_sums_kernel);

namespace {

using RowMajorHomography = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
constexpr std::size_t kTransferBlockSize = 64;

// Index of the entry (i, j) of a symmetric 3x3 matrix in its row-major upper triangle.
int upper_index(int i, int j) {
  constexpr std::array<int, 9> kIndex{0, 1, 2, 1, 3, 4, 2, 4, 5};
  return kIndex[static_cast<std::size_t>(3 * i + j)];
}

}  // namespace

double transfer_error(const Eigen::Matrix3d& H, const BearingPair& pair) {
  const Eigen::Vector3d moved = H * pair.reference.homogeneous();
  if (!(moved.z() > 1e-6)) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d at = moved.hnormalized();
  const Eigen::Matrix2d A = (H.topLeftCorner<2, 2>() - at * H.bottomLeftCorner<1, 2>()) / moved.z();
  const Eigen::Matrix2d C = Eigen::Matrix2d::Identity() + A * A.transpose();
  const Eigen::Vector2d r = pair.current - at;
  return std::sqrt(r.dot(C.ldlt().solve(r)));
}

TransferSums transfer_sums(const BearingColumns& columns, const Eigen::Matrix3d& H, double cutoff) {
  const RowMajorHomography rows = H;
  std::array<double, 49> sum{};
  HWY_DYNAMIC_DISPATCH(transfer_sums_kernel)(columns, rows.data(), 1 / (cutoff * cutoff), sum);
  TransferSums sums;
  for (int p = 0; p < 9; ++p) {
    for (int q = 0; q < 9; ++q) {
      sums.normal(p, q) =
          sum[static_cast<std::size_t>(6 * upper_index(p / 3, q / 3) + upper_index(p % 3, q % 3))];
    }
    sums.gradient[p] = sum[36 + static_cast<std::size_t>(p)];
  }
  sums.squared_influence = sum[45];
  sums.slope = sum[46];
  sums.weight = sum[47];
  sums.count = sum[48];
  return sums;
}

std::vector<float> transfer_distances(const BearingColumns& columns, const Eigen::Matrix3d& H) {
  const RowMajorHomography rows = H;
  std::vector<float> distances(columns.padded());
  HWY_DYNAMIC_DISPATCH(transfer_distances_kernel)
  (columns, 0, columns.padded(), rows.data(), distances.data());
  distances.resize(columns.size());
  return distances;
}

double truncated_transfer_cost(const BearingColumns& columns, const Eigen::Matrix3d& H,
                               double threshold, double cost_limit) {
  const RowMajorHomography rows = H;
  const auto scale = static_cast<float>(1 / threshold);
  const auto count = static_cast<double>(columns.size());
  std::array<float, kTransferBlockSize> distances{};
  double sum = 0;
  for (std::size_t begin = 0; begin < columns.padded(); begin += kTransferBlockSize) {
    const std::size_t end = std::min(begin + kTransferBlockSize, columns.padded());
    HWY_DYNAMIC_DISPATCH(transfer_distances_kernel)
    (columns, begin, end, rows.data(), distances.data());
    const std::size_t last = std::min(end, columns.size());
    for (std::size_t i = begin; i < last; ++i) {
      const float in_thresholds = distances[i - begin] * scale;
      sum += std::min(in_thresholds * in_thresholds, 1.0F);
    }
    if (sum > cost_limit) return sum;
    const auto scored = static_cast<double>(last);
    if (sum - 2 * std::sqrt(scored) > cost_limit * scored / count) return sum * count / scored;
  }
  return sum;
}

}  // namespace stillkite
#endif  // HWY_ONCE
