#include "estimation/two_view/epipolar_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimation/two_view/epipolar_error.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// One SIMD vector of pairs: l = E a, m = E^T b and b^T E a.
template <class D>
struct Epipolar {
  using V = hn::Vec<D>;
  V lx, ly, mx, my, algebraic, squared_norm;

  Epipolar(D d, const std::array<V, 9>& E, V ax, V ay, V bx, V by)
      : lx(hn::MulAdd(E[0], ax, hn::MulAdd(E[1], ay, E[2]))),
        ly(hn::MulAdd(E[3], ax, hn::MulAdd(E[4], ay, E[5]))),
        mx(hn::MulAdd(E[0], bx, hn::MulAdd(E[3], by, E[6]))),
        my(hn::MulAdd(E[1], bx, hn::MulAdd(E[4], by, E[7]))) {
    const V lz = hn::MulAdd(E[6], ax, hn::MulAdd(E[7], ay, E[8]));
    algebraic = hn::MulAdd(bx, lx, hn::MulAdd(by, ly, lz));
    const V norm = hn::MulAdd(lx, lx, hn::MulAdd(ly, ly, hn::MulAdd(mx, mx, hn::Mul(my, my))));
    // both points at their epipoles: E a and E^T b are 0
    squared_norm = hn::Max(norm, hn::Set(d, static_cast<hn::TFromD<D>>(1e-30)));
  }
};

template <class D>
std::array<hn::Vec<D>, 9> broadcast(D d, const double* E) {
  std::array<hn::Vec<D>, 9> v;
  for (std::size_t k = 0; k < 9; ++k) v[k] = hn::Set(d, static_cast<hn::TFromD<D>>(E[k]));
  return v;
}

using FloatsD = hn::CappedTag<float, BearingColumns::kPadding>;
using DoublesD = hn::CappedTag<double, BearingColumns::kPadding>;

double cost_kernel(const BearingColumns& c, std::size_t begin, std::size_t end, const double* E,
                   float inverse_squared_threshold) {
  const FloatsD d;
  using V = hn::Vec<FloatsD>;
  const std::array<V, 9> e = broadcast(d, E);
  const V scale = hn::Set(d, inverse_squared_threshold);
  const V one = hn::Set(d, 1.0F);
  V sum = hn::Zero(d);
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    const Epipolar<FloatsD> at(d, e, hn::LoadU(d, &c.fax[i]), hn::LoadU(d, &c.fay[i]),
                               hn::LoadU(d, &c.fbx[i]), hn::LoadU(d, &c.fby[i]));
    const V squared = hn::Div(hn::Mul(hn::Mul(at.algebraic, at.algebraic), scale), at.squared_norm);
    sum = hn::MulAdd(hn::Min(squared, one), hn::LoadU(d, &c.fweight[i]), sum);
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

void distances_of_pairs_kernel(const BearingColumns& c, const double* E, float* out) {
  const FloatsD d;
  const std::array<hn::Vec<FloatsD>, 9> e = broadcast(d, E);
  for (std::size_t i = 0; i < c.padded(); i += hn::Lanes(d)) {
    const Epipolar<FloatsD> at(d, e, hn::LoadU(d, &c.fax[i]), hn::LoadU(d, &c.fay[i]),
                               hn::LoadU(d, &c.fbx[i]), hn::LoadU(d, &c.fby[i]));
    hn::StoreU(hn::Div(hn::Abs(at.algebraic), hn::Sqrt(at.squared_norm)), d, out + i);
  }
}

// SampsonSums: 45 entries of the normal matrix, 9 of the gradient, 4 sums.
void sampson_kernel(const BearingColumns& c, const double* E, double inverse_squared_cutoff,
                    std::array<double, 58>& out) {
  const DoublesD d;
  using V = hn::Vec<DoublesD>;
  const std::array<V, 9> e = broadcast(d, E);
  const V scale = hn::Set(d, inverse_squared_cutoff);
  const V one = hn::Set(d, 1.0), five = hn::Set(d, 5.0), zero = hn::Zero(d);
  std::array<V, 58> sum;
  sum.fill(zero);
  for (std::size_t i = 0; i < c.padded(); i += hn::Lanes(d)) {
    const V ax = hn::LoadU(d, &c.ax[i]), ay = hn::LoadU(d, &c.ay[i]);
    const V bx = hn::LoadU(d, &c.bx[i]), by = hn::LoadU(d, &c.by[i]);
    const Epipolar<DoublesD> at(d, e, ax, ay, bx, by);
    const V inverse_norm = hn::Div(one, hn::Sqrt(at.squared_norm));
    const V error = hn::Mul(at.algebraic, inverse_norm);
    const V u = hn::Mul(hn::Mul(error, error), scale);
    const V root_weight = hn::Mul(hn::Max(hn::Sub(one, u), zero), hn::LoadU(d, &c.weight[i]));
    const V w = hn::Mul(root_weight, root_weight);
    // e = C / sqrt(D): de = dC / sqrt(D) - (e / D) dD / 2
    const V f = hn::Neg(hn::Mul(error, hn::Mul(inverse_norm, inverse_norm)));
    const V fl = hn::Mul(f, at.lx), fk = hn::Mul(f, at.ly);
    const V fm = hn::Mul(f, at.mx), fn = hn::Mul(f, at.my);
    const V sax = hn::Mul(inverse_norm, ax), say = hn::Mul(inverse_norm, ay);
    const std::array<V, 9> g{hn::MulAdd(bx, sax, hn::MulAdd(fl, ax, hn::Mul(fm, bx))),
                             hn::MulAdd(bx, say, hn::MulAdd(fl, ay, hn::Mul(fn, bx))),
                             hn::MulAdd(bx, inverse_norm, fl),
                             hn::MulAdd(by, sax, hn::MulAdd(fk, ax, hn::Mul(fm, by))),
                             hn::MulAdd(by, say, hn::MulAdd(fk, ay, hn::Mul(fn, by))),
                             hn::MulAdd(by, inverse_norm, fk),
                             hn::Add(sax, fm),
                             hn::Add(say, fn),
                             inverse_norm};
    std::size_t k = 0;
    for (std::size_t p = 0; p < 9; ++p) {
      const V wg = hn::Mul(w, g[p]);
      for (std::size_t q = 0; q <= p; ++q, ++k) sum[k] = hn::MulAdd(wg, g[q], sum[k]);
      sum[45 + p] = hn::MulAdd(wg, error, sum[45 + p]);
    }
    const V influence = hn::Mul(w, error);
    sum[54] = hn::MulAdd(influence, influence, sum[54]);
    sum[55] = hn::MulAdd(root_weight, hn::NegMulAdd(five, u, one), sum[55]);
    sum[56] = hn::Add(sum[56], w);
    sum[57] = hn::Add(sum[57], hn::IfThenElseZero(hn::Gt(root_weight, zero), one));
  }
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = hn::GetLane(hn::SumOfLanes(d, sum[k]));
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(cost_kernel);
HWY_EXPORT(distances_of_pairs_kernel);
HWY_EXPORT(sampson_kernel);

namespace {

using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr std::size_t kBlockSize = 64;

}  // namespace

Eigen::Matrix3d essential_matrix(const RelativePose& pose) {
  return skew(pose.direction) * pose.current_from_reference.toRotationMatrix();
}

double sampson_error(const Eigen::Matrix3d& E, const BearingPair& pair) {
  const Eigen::Vector3d a = pair.reference.homogeneous();
  const Eigen::Vector3d b = pair.current.homogeneous();
  const Eigen::Vector3d l = E * a;
  const Eigen::Vector3d m = E.transpose() * b;
  const double squared_norm = l.head<2>().squaredNorm() + m.head<2>().squaredNorm();
  return squared_norm > 0 ? b.dot(l) / std::sqrt(squared_norm) : 0;
}

BearingColumns::BearingColumns(std::span<const BearingPair> pairs, std::span<const int> order)
    : size_(order.size()) {
  const std::size_t count = (size_ + kPadding - 1) / kPadding * kPadding;
  for (auto* column : {&ax, &ay, &bx, &by, &weight}) column->assign(count, 0);
  for (auto* column : {&fax, &fay, &fbx, &fby, &fweight}) column->assign(count, 0);
  for (std::size_t i = 0; i < size_; ++i) {
    const BearingPair& pair = pairs[static_cast<std::size_t>(order[i])];
    ax[i] = pair.reference.x(), ay[i] = pair.reference.y();
    bx[i] = pair.current.x(), by[i] = pair.current.y();
    fax[i] = static_cast<float>(ax[i]), fay[i] = static_cast<float>(ay[i]);
    fbx[i] = static_cast<float>(bx[i]), fby[i] = static_cast<float>(by[i]);
    weight[i] = 1, fweight[i] = 1;
  }
}

BearingColumns::BearingColumns(const BearingColumns& all, std::span<const std::size_t> indices)
    : size_(indices.size()) {
  const std::size_t count = (size_ + kPadding - 1) / kPadding * kPadding;
  const auto take = [&](auto column) {
    (this->*column).assign(count, 0);
    for (std::size_t i = 0; i < size_; ++i) (this->*column)[i] = (all.*column)[indices[i]];
  };
  for (const auto column : {&BearingColumns::ax, &BearingColumns::ay, &BearingColumns::bx,
                            &BearingColumns::by, &BearingColumns::weight}) {
    take(column);
  }
  for (const auto column : {&BearingColumns::fax, &BearingColumns::fay, &BearingColumns::fbx,
                            &BearingColumns::fby, &BearingColumns::fweight}) {
    take(column);
  }
}

SampsonSums sampson_sums(const BearingColumns& columns, const Eigen::Matrix3d& E, double cutoff) {
  const RowMajor3d rows = E;
  std::array<double, 58> sum{};
  HWY_DYNAMIC_DISPATCH(sampson_kernel)(columns, rows.data(), 1 / (cutoff * cutoff), sum);
  SampsonSums sums;
  std::size_t k = 0;
  for (int p = 0; p < 9; ++p) {
    for (int q = 0; q <= p; ++q, ++k) sums.normal(p, q) = sums.normal(q, p) = sum[k];
    sums.gradient[p] = sum[45 + static_cast<std::size_t>(p)];
  }
  sums.squared_influence = sum[54];
  sums.slope = sum[55];
  sums.weight = sum[56];
  sums.count = sum[57];
  return sums;
}

double truncated_cost(const BearingColumns& columns, const Eigen::Matrix3d& E, double threshold,
                      double cost_limit) {
  const RowMajor3d rows = E;
  const auto scale = static_cast<float>(1 / (threshold * threshold));
  const auto cost = HWY_DYNAMIC_DISPATCH(cost_kernel);
  const auto count = static_cast<double>(columns.size());
  double sum = 0;
  for (std::size_t begin = 0; begin < columns.padded(); begin += kBlockSize) {
    const std::size_t end = std::min(begin + kBlockSize, columns.padded());
    sum += cost(columns, begin, end, rows.data(), scale);
    if (sum > cost_limit) return sum;
    // a term lies in [0, 1]: standard deviation <= 1/2
    const auto scored = static_cast<double>(std::min(end, columns.size()));
    if (sum - 2 * std::sqrt(scored) > cost_limit * scored / count) return sum * count / scored;
  }
  return sum;
}

std::vector<float> sampson_distances(const BearingColumns& columns, const Eigen::Matrix3d& E) {
  const RowMajor3d rows = E;
  std::vector<float> distances(columns.padded());
  HWY_DYNAMIC_DISPATCH(distances_of_pairs_kernel)(columns, rows.data(), distances.data());
  distances.resize(columns.size());
  return distances;
}

}  // namespace stillkite
#endif  // HWY_ONCE
