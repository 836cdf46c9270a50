#include "estimation/fusion/dense_update.hpp"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimation/fusion/dense_update.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Eigen::Index;

constexpr Index kDown = 2;
constexpr Index kAcross = 4;  // eight sums and what they are of fill the registers of AVX2
constexpr Index kPanel = 8;   // columns that stay in the first cache

struct Columns {
  const double* data;
  Index rows, count;
  // beyond the last one that again
  [[nodiscard]] const double* at(Index i) const { return data + std::min(i, count - 1) * rows; }
};

using Dots = std::array<std::array<double, kAcross>, kDown>;

// Columns of A, from i on, times columns of B, from j on: of their first `rows` entries.
Dots dots(const Columns& A, Index i, const Columns& B, Index j, Index rows) {
  const hn::ScalableTag<double> d;
  using V = hn::Vec<decltype(d)>;
  const auto lanes = static_cast<Index>(hn::Lanes(d));
  const double *a0 = A.at(i), *a1 = A.at(i + 1);
  const double *b0 = B.at(j), *b1 = B.at(j + 1);
  const double *b2 = B.at(j + 2), *b3 = B.at(j + 3);
  const V zero = hn::Zero(d);
  V s00 = zero, s01 = zero, s02 = zero, s03 = zero;
  V s10 = zero, s11 = zero, s12 = zero, s13 = zero;
  Index row = 0;
  for (; row + lanes <= rows; row += lanes) {
    const V x0 = hn::LoadU(d, a0 + row), x1 = hn::LoadU(d, a1 + row);
    const V y0 = hn::LoadU(d, b0 + row), y1 = hn::LoadU(d, b1 + row);
    const V y2 = hn::LoadU(d, b2 + row), y3 = hn::LoadU(d, b3 + row);
    s00 = hn::MulAdd(x0, y0, s00), s10 = hn::MulAdd(x1, y0, s10);
    s01 = hn::MulAdd(x0, y1, s01), s11 = hn::MulAdd(x1, y1, s11);
    s02 = hn::MulAdd(x0, y2, s02), s12 = hn::MulAdd(x1, y2, s12);
    s03 = hn::MulAdd(x0, y3, s03), s13 = hn::MulAdd(x1, y3, s13);
  }
  const auto sum = [&](V v) { return hn::GetLane(hn::SumOfLanes(d, v)); };
  Dots out{{{sum(s00), sum(s01), sum(s02), sum(s03)}, {sum(s10), sum(s11), sum(s12), sum(s13)}}};
  for (; row < rows; ++row) {
    const std::array<double, kAcross> y{b0[row], b1[row], b2[row], b3[row]};
    for (std::size_t k = 0; k < y.size(); ++k) {
      out[0][k] += a0[row] * y[k];
      out[1][k] += a1[row] * y[k];
    }
  }
  return out;
}

// Forward substitution, two rows of four columns at a time.
void solve_kernel(const double* U, Index rows, double* B, Index columns) {
  for (Index panel = 0; panel < columns; panel += kPanel) {
    for (Index r = 0; r < rows; r += kDown) {
      std::array<double, kDown> inverse{};
      for (Index i = r; i < std::min(r + kDown, rows); ++i) inverse[i - r] = 1 / U[i * rows + i];
      for (Index c = panel; c < std::min(panel + kPanel, columns); c += kAcross) {
        const Dots known = dots({U, rows, rows}, r, {B, rows, columns}, c, r);
        for (Index j = c; j < std::min(c + kAcross, columns); ++j) {
          double* x = B + j * rows;
          for (Index i = r; i < std::min(r + kDown, rows); ++i) {
            const double* u = U + i * rows;
            x[i] -= known[i - r][j - c];
            for (Index k = r; k < i; ++k) x[i] -= u[k] * x[k];
            x[i] *= inverse[i - r];
          }
        }
      }
    }
  }
}

void gram_kernel(const double* A, Index rows, Index columns, double* P, Index stride) {
  for (Index panel = 0; panel < columns; panel += kPanel) {
    for (Index r = panel; r < columns; r += kDown) {
      const Index end = std::min(r + kDown, columns);
      for (Index c = panel; c < std::min(panel + kPanel, end); c += kAcross) {
        const Dots product = dots({A, rows, columns}, r, {A, rows, columns}, c, rows);
        for (Index i = r; i < end; ++i) {
          for (Index j = c; j < std::min(c + kAcross, i + 1); ++j) {
            P[i * stride + j] = P[j * stride + i] -= product[i - r][j - c];
          }
        }
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {

HWY_EXPORT(solve_kernel);
HWY_EXPORT(gram_kernel);

void solve_transposed(const Eigen::MatrixXd& U, Eigen::MatrixXd& B) {
  HWY_DYNAMIC_DISPATCH(solve_kernel)(U.data(), U.rows(), B.data(), B.cols());
}

void subtract_gram(const Eigen::MatrixXd& A, Eigen::MatrixXd& P) {
  HWY_DYNAMIC_DISPATCH(gram_kernel)(A.data(), A.rows(), A.cols(), P.data(), P.rows());
}

}  // namespace stillkite
#endif
