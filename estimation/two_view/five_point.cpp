#include "estimation/two_view/five_point.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>

#include "estimation/two_view/polynomial_roots.hpp"

namespace stillkite {
namespace {

// Polynomials in x, y, z.
using Linear = std::array<double, 4>;      // x y z 1
using Quadratic = std::array<double, 10>;  // x2 xy xz x y2 yz y z2 z 1
// Nister's order: x3 y3 x2y xy2 x2z x2 y2z y2 xyz xy | xz2 xz x yz2 yz y z3 z2 z 1
using Cubic = std::array<double, 20>;
using Constraints = std::array<Cubic, 10>;

Quadratic operator*(const Linear& a, const Linear& b) {
  return {a[0] * b[0],
          a[0] * b[1] + a[1] * b[0],
          a[0] * b[2] + a[2] * b[0],
          a[0] * b[3] + a[3] * b[0],
          a[1] * b[1],
          a[1] * b[2] + a[2] * b[1],
          a[1] * b[3] + a[3] * b[1],
          a[2] * b[2],
          a[2] * b[3] + a[3] * b[2],
          a[3] * b[3]};
}

// sum += p b
void add_product(Cubic& sum, const Quadratic& p, const Linear& b) {
  sum[0] += p[0] * b[0];
  sum[1] += p[4] * b[1];
  sum[2] += p[0] * b[1] + p[1] * b[0];
  sum[3] += p[1] * b[1] + p[4] * b[0];
  sum[4] += p[0] * b[2] + p[2] * b[0];
  sum[5] += p[0] * b[3] + p[3] * b[0];
  sum[6] += p[4] * b[2] + p[5] * b[1];
  sum[7] += p[4] * b[3] + p[6] * b[1];
  sum[8] += p[1] * b[2] + p[2] * b[1] + p[5] * b[0];
  sum[9] += p[1] * b[3] + p[3] * b[1] + p[6] * b[0];
  sum[10] += p[2] * b[2] + p[7] * b[0];
  sum[11] += p[2] * b[3] + p[3] * b[2] + p[8] * b[0];
  sum[12] += p[3] * b[3] + p[9] * b[0];
  sum[13] += p[5] * b[2] + p[7] * b[1];
  sum[14] += p[5] * b[3] + p[6] * b[2] + p[8] * b[1];
  sum[15] += p[6] * b[3] + p[9] * b[1];
  sum[16] += p[7] * b[2];
  sum[17] += p[7] * b[3] + p[8] * b[2];
  sum[18] += p[8] * b[3] + p[9] * b[2];
  sum[19] += p[9] * b[3];
}

void add(Quadratic& sum, const Quadratic& p, double factor = 1) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * p[i];
}

using NullSpace = Eigen::Matrix<double, 9, 4>;

NullSpace null_space(std::span<const BearingPair, 5> pairs) {
  Eigen::Matrix<double, 9, 5> epipolar;
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d a = pairs[i].reference.homogeneous();
    const Eigen::Vector3d b = pairs[i].current.homogeneous();
    epipolar.col(i) << b.x() * a, b.y() * a, b.z() * a;  // row by row of E
  }
  const Eigen::HouseholderQR<Eigen::Matrix<double, 9, 5>> qr(epipolar);
  NullSpace basis = NullSpace::Zero();
  basis.bottomRows<4>().setIdentity();
  basis.applyOnTheLeft(qr.householderQ());
  return basis;
}

// 2 E E^T E - tr(E E^T) E = 0, nine rows, and det E = 0.
Constraints essential_constraints(const NullSpace& basis) {
  std::array<std::array<Linear, 3>, 3> E{};
  for (int i = 0; i < 9; ++i) {
    E[i / 3][i % 3] = {basis(i, 0), basis(i, 1), basis(i, 2), basis(i, 3)};
  }
  std::array<std::array<Quadratic, 3>, 3> L{};  // E E^T - tr(E E^T) / 2
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) add(L[i][j], E[i][k] * E[j][k]);
      L[j][i] = L[i][j];
    }
  }
  Quadratic half_trace{};
  for (int i = 0; i < 3; ++i) add(half_trace, L[i][i], 0.5);
  for (int i = 0; i < 3; ++i) add(L[i][i], half_trace, -1);
  Constraints rows{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) add_product(rows[3 * i + j], L[i][k], E[k][j]);
    }
  }
  for (int j = 0; j < 3; ++j) {
    Quadratic minor = E[0][(j + 1) % 3] * E[1][(j + 2) % 3];
    add(minor, E[0][(j + 2) % 3] * E[1][(j + 1) % 3], -1);
    add_product(rows[9], minor, E[2][j]);
  }
  return rows;
}

// Gauss-Jordan elimination of the first ten columns; rows 0..3 are only needed as pivots, so they
// are not back-substituted. False: singular.
bool eliminate(Constraints& M) {
  for (int c = 0; c < 10; ++c) {
    int pivot = c;
    for (int r = c + 1; r < 10; ++r) {
      if (std::abs(M[r][c]) > std::abs(M[pivot][c])) pivot = r;
    }
    if (!(std::abs(M[pivot][c]) > 1e-14)) return false;
    std::swap(M[c], M[pivot]);
    const double scale = 1 / M[c][c];
    for (int k = c; k < 20; ++k) M[c][k] *= scale;
    for (int r = c < 4 ? c + 1 : 4; r < 10; ++r) {
      if (r == c) continue;
      const double factor = M[r][c];
      for (int k = c; k < 20; ++k) M[r][k] -= factor * M[c][k];
    }
  }
  return true;
}

// Coefficients of x, y, 1: cubic, cubic and quartic in z, ascending.
struct RowInZ {
  std::array<double, 4> x, y;
  std::array<double, 5> one;
};

// <e> - z <f> of Nister's table: only monomials linear in x and y remain.
RowInZ subtract_z_times(const Cubic& e, const Cubic& f) {
  return {{e[12], e[11] - f[12], e[10] - f[11], -f[10]},
          {e[15], e[14] - f[15], e[13] - f[14], -f[13]},
          {e[19], e[18] - f[19], e[17] - f[18], e[16] - f[17], -f[16]}};
}

template <std::size_t N, std::size_t M>
std::array<double, N + M - 1> multiply(const std::array<double, N>& a,
                                       const std::array<double, M>& b) {
  std::array<double, N + M - 1> product{};
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < M; ++j) product[i + j] += a[i] * b[j];
  }
  return product;
}
template <std::size_t N>
std::array<double, N> difference(std::array<double, N> a, const std::array<double, N>& b) {
  for (std::size_t i = 0; i < N; ++i) a[i] -= b[i];
  return a;
}

// det [k; l; m] along the third row.
Polynomial determinant(const RowInZ& k, const RowInZ& l, const RowInZ& m) {
  const auto of_x = multiply(difference(multiply(k.y, l.one), multiply(l.y, k.one)), m.x);
  const auto of_y = multiply(difference(multiply(l.x, k.one), multiply(k.x, l.one)), m.y);
  const auto of_one = multiply(difference(multiply(k.x, l.y), multiply(l.x, k.y)), m.one);
  Polynomial sum{};
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = of_x[i] + of_y[i] + of_one[i];
  return sum;
}

Eigen::Vector3d row_at(const RowInZ& row, double z) {
  const auto value = [z](const auto& c) {
    double sum = 0;
    for (auto i = c.size(); i-- > 0;) sum = sum * z + c[i];
    return sum;
  };
  return {value(row.x), value(row.y), value(row.one)};
}

// Gauss-Newton step of (x, y, z) on the ten constraints; compensates rounding in the polynomial's
// coefficients.
Eigen::Vector3d polish(const Constraints& rows, const Eigen::Vector3d& at) {
  const double x = at.x(), y = at.y(), z = at.z();
  const Cubic value{x * x * x, y * y * y, x * x * y, x * y * y, x * x * z, x * x, y * y * z,
                    y * y,     x * y * z, x * y,     x * z * z, x * z,     x,     y * z * z,
                    y * z,     y,         z * z * z, z * z,     z,         1};
  const Cubic by_x{3 * x * x, 0, 2 * x * y, y * y, 2 * x * z, 2 * x, 0, 0, y * z, y,
                   z * z,     z, 1,         0,     0,         0,     0, 0, 0,     0};
  const Cubic by_y{0, 3 * y * y, x * x, 2 * x * y, 0, 0, 2 * y * z, 2 * y, x * z, x,
                   0, 0,         0,     z * z,     z, 1, 0,         0,     0,     0};
  const Cubic by_z{0,         0, 0, 0,         x * x, 0, y * y,     0,     x * y, 0,
                   2 * x * z, x, 0, 2 * y * z, y,     0, 3 * z * z, 2 * z, 1,     0};
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const Cubic& row : rows) {
    Eigen::Vector3d J = Eigen::Vector3d::Zero();
    double residual = 0;
    for (std::size_t i = 0; i < row.size(); ++i) {
      residual += row[i] * value[i];
      J += row[i] * Eigen::Vector3d(by_x[i], by_y[i], by_z[i]);
    }
    A += J * J.transpose();
    b += J * residual;
  }
  const Eigen::Vector3d step = A.ldlt().solve(b);
  return step.allFinite() && step.norm() < 0.1 * (1 + at.norm()) ? Eigen::Vector3d(at - step) : at;
}

}  // namespace

EssentialCandidates solve_five_point(std::span<const BearingPair, 5> pairs) {
  EssentialCandidates found;
  const NullSpace basis = null_space(pairs);
  const Constraints constraints = essential_constraints(basis);
  Constraints M = constraints;
  if (!eliminate(M)) return found;
  const RowInZ k = subtract_z_times(M[4], M[5]);
  const RowInZ l = subtract_z_times(M[6], M[7]);
  const RowInZ m = subtract_z_times(M[8], M[9]);
  const RealRoots roots = real_roots(determinant(k, l, m));
  for (int i = 0; i < roots.count; ++i) {
    const double z = roots.root[i];
    const Eigen::Vector3d a = row_at(k, z), b = row_at(l, z), c = row_at(m, z);
    Eigen::Vector3d v = a.cross(b);
    if (const Eigen::Vector3d w = a.cross(c); w.squaredNorm() > v.squaredNorm()) v = w;
    if (const Eigen::Vector3d w = b.cross(c); w.squaredNorm() > v.squaredNorm()) v = w;
    if (v.z() == 0) continue;
    const Eigen::Vector3d xyz = polish(constraints, {v.x() / v.z(), v.y() / v.z(), z});
    const Eigen::Matrix<double, 9, 1> e = basis * xyz.homogeneous();
    const double norm = e.norm();
    if (!std::isfinite(norm) || !(norm > 0)) continue;
    found.essential[found.count++] =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(e.data()) *
        (std::sqrt(2.0) / norm);
  }
  return found;
}

}  // namespace stillkite
