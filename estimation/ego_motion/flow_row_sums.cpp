#include <array>
#include <cstddef>
#include <span>

#include "estimation/ego_motion/flow_rows.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimation/ego_motion/flow_row_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, FlowRows::kPadding>;
using V = hn::Vec<D>;

// Rotational columns of the motion field: d(x, y)/dt by w_x, w_y, w_z.
struct Rotation {
  std::array<V, 3> x, y;
};

Rotation rotation_of(V x, V y) {
  const V one = hn::Set(D(), 1.0);
  const V xy = hn::Mul(x, y);
  return {{xy, hn::Neg(hn::MulAdd(x, x, one)), y},
          {hn::MulAdd(y, y, one), hn::Neg(xy), hn::Neg(x)}};
}

// Vectorised motion_field (motion_field.hpp). The translational columns are rho (-1, 0),
// rho (0, -1) and rho b: their products with G need only G, G b and b^T G b.
void sums_kernel(const FlowRows& rows, std::size_t begin, std::size_t end, const double* weights,
                 std::array<double, 27>& out) {
  const D d;
  std::array<V, 27> sum;
  sum.fill(hn::Zero(d));
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    const V w = hn::LoadU(d, weights + i);
    const V gxx = hn::Mul(w, hn::LoadU(d, &rows.gxx[i]));
    const V gxy = hn::Mul(w, hn::LoadU(d, &rows.gxy[i]));
    const V gyy = hn::Mul(w, hn::LoadU(d, &rows.gyy[i]));
    const V x = hn::LoadU(d, &rows.x[i]);
    const V y = hn::LoadU(d, &rows.y[i]);
    const V rho = hn::LoadU(d, &rows.inverse_depth[i]);
    const V ux = hn::LoadU(d, &rows.flow_x[i]);
    const V uy = hn::LoadU(d, &rows.flow_y[i]);
    std::size_t k = 0;
    const auto add = [&](V a, V b) {
      sum[k] = hn::MulAdd(a, b, sum[k]);
      ++k;
    };
    // translation block: rho^2 times the products with -1, -1 and b
    const V rho2 = hn::Mul(rho, rho);
    const V gbx = hn::MulAdd(gxx, x, hn::Mul(gxy, y));
    const V gby = hn::MulAdd(gxy, x, hn::Mul(gyy, y));
    add(rho2, gxx);
    add(rho2, gxy);
    add(rho2, hn::Neg(gbx));
    add(rho2, gyy);
    add(rho2, hn::Neg(gby));
    add(rho2, hn::MulAdd(x, gbx, hn::Mul(y, gby)));
    // translation-rotation and rotation blocks
    const Rotation m = rotation_of(x, y);
    const V minus_rho = hn::Neg(rho);
    for (std::size_t j = 0; j < 3; ++j) {
      const V gmx = hn::MulAdd(gxx, m.x[j], hn::Mul(gxy, m.y[j]));
      const V gmy = hn::MulAdd(gxy, m.x[j], hn::Mul(gyy, m.y[j]));
      add(minus_rho, gmx);
      add(minus_rho, gmy);
      add(rho, hn::MulAdd(x, gmx, hn::Mul(y, gmy)));
      for (std::size_t row = 0; row <= j; ++row) {
        sum[k] = hn::MulAdd(m.x[row], gmx, hn::MulAdd(m.y[row], gmy, sum[k]));
        ++k;
      }
    }
    // right-hand side
    const V gux = hn::MulAdd(gxx, ux, hn::Mul(gxy, uy));
    const V guy = hn::MulAdd(gxy, ux, hn::Mul(gyy, uy));
    add(minus_rho, gux);
    add(minus_rho, guy);
    add(rho, hn::MulAdd(x, gux, hn::Mul(y, guy)));
    for (std::size_t j = 0; j < 3; ++j) {
      sum[k] = hn::MulAdd(m.x[j], gux, hn::MulAdd(m.y[j], guy, sum[k]));
      ++k;
    }
  }
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = hn::GetLane(hn::SumOfLanes(d, sum[k]));
}

void distances_kernel(const FlowRows& rows, const std::array<double, 6>& twist, double* out) {
  const D d;
  const V vx = hn::Set(d, twist[0]), vy = hn::Set(d, twist[1]), vz = hn::Set(d, twist[2]);
  const std::array<V, 3> w{hn::Set(d, twist[3]), hn::Set(d, twist[4]), hn::Set(d, twist[5])};
  for (std::size_t i = 0; i < rows.size(); i += hn::Lanes(d)) {
    const V x = hn::LoadU(d, &rows.x[i]);
    const V y = hn::LoadU(d, &rows.y[i]);
    const V rho = hn::LoadU(d, &rows.inverse_depth[i]);
    const Rotation m = rotation_of(x, y);
    // flow - rho (b v_z - v) - rotation
    V rx = hn::NegMulAdd(rho, hn::MulSub(x, vz, vx), hn::LoadU(d, &rows.flow_x[i]));
    V ry = hn::NegMulAdd(rho, hn::MulSub(y, vz, vy), hn::LoadU(d, &rows.flow_y[i]));
    for (std::size_t j = 0; j < 3; ++j) {
      rx = hn::NegMulAdd(m.x[j], w[j], rx);
      ry = hn::NegMulAdd(m.y[j], w[j], ry);
    }
    const V gxx = hn::LoadU(d, &rows.gxx[i]);
    const V gxy = hn::LoadU(d, &rows.gxy[i]);
    const V gyy = hn::LoadU(d, &rows.gyy[i]);
    const V grx = hn::MulAdd(gxx, rx, hn::Mul(gxy, ry));
    const V gry = hn::MulAdd(gxy, rx, hn::Mul(gyy, ry));
    // rounding of a singular G may give a negative value
    hn::StoreU(hn::Max(hn::Zero(d), hn::MulAdd(rx, grx, hn::Mul(ry, gry))), d, out + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(sums_kernel);
HWY_EXPORT(distances_kernel);

TwistEquations weighted_sums(const FlowRows& rows, std::size_t begin, std::size_t end,
                             std::span<const double> weights) {
  std::array<double, 27> sum{};
  HWY_DYNAMIC_DISPATCH(sums_kernel)(rows, begin, end, weights.data(), sum);
  TwistEquations out;
  std::size_t k = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) out.N(row, column) = sum[k++];
  }
  for (int column = 3; column < 6; ++column) {
    for (int row = 0; row <= column; ++row) out.N(row, column) = sum[k++];
  }
  out.N.triangularView<Eigen::StrictlyLower>() = out.N.transpose();
  for (int i = 0; i < 6; ++i) out.b(i) = sum[k++];
  return out;
}

void compute_squared_distances(const FlowRows& rows, const Vector6d& twist,
                               std::span<double> squared_distances) {
  const std::array<double, 6> components{twist(0), twist(1), twist(2),
                                         twist(3), twist(4), twist(5)};
  HWY_DYNAMIC_DISPATCH(distances_kernel)(rows, components, squared_distances.data());
}

}  // namespace stillkite
#endif
