#include "estimation/two_view/polynomial_roots.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

// p_0 = p, p_1 = p', p_k+1 = -(p_k-1 mod p_k) up to a positive factor. If every remainder is one
// degree lower than its divisor, p_k-1 = (slope z + offset) p_k - scale p_k+1. The recurrence costs
// a fifth of evaluating each polynomial.
class SturmChain {
 public:
  SturmChain(const Polynomial& p, int degree) {
    Polynomial above = p;
    Polynomial below{};
    for (int i = 1; i <= degree; ++i) below[i - 1] = i * p[i];
    int n = degree;  // of `above`
    while (n > 0) {
      Link& link = links_[length_++];
      link.slope = above[n] / below[n - 1];
      link.offset = n > 1 ? (above[n - 1] - link.slope * below[n - 2]) / below[n - 1] : 0;
      if (n == 1) link.offset = above[0] / below[0];
      Polynomial remainder{};
      double largest = 0;
      for (int i = 0; i < n - 1; ++i) {
        const double shifted = i > 0 ? below[i - 1] : 0;
        remainder[i] = link.slope * shifted + link.offset * below[i] - above[i];
        largest = std::max(largest, std::abs(remainder[i]));
      }
      last_ = below[n - 1];
      // rounding-only remainder: repeated root, `below` is the greatest common divisor
      if (n == 1 || !(largest > 0) || !(std::abs(remainder[n - 2]) > 1e-14 * largest)) break;
      link.scale = largest;
      for (double& c : remainder) c /= largest;
      above = below;
      below = remainder;
      --n;
    }
  }

  /// Sign changes along the chain; decreases by one at each root below z.
  [[nodiscard]] int sign_changes(double z) const {
    double below = 0;
    double current = last_;
    int changes = 0;
    for (int k = length_ - 1; k >= 0; --k) {
      const Link& link = links_[k];
      const double above = (link.slope * z + link.offset) * current - link.scale * below;
      changes += (above < 0) != (current < 0) ? 1 : 0;
      below = current;
      current = above;
    }
    return changes;
  }

 private:
  struct Link {
    double slope = 0, offset = 0, scale = 0;
  };
  std::array<Link, kMaxDegree> links_{};
  double last_ = 0;
  int length_ = 0;
};

struct ValueAndSlope {
  double value, slope;
};
ValueAndSlope evaluate(const Polynomial& p, int degree, double z) {
  double value = p[degree];
  double slope = 0;
  for (int i = degree - 1; i >= 0; --i) {
    slope = slope * z + value;
    value = value * z + p[i];
  }
  return {value, slope};
}

// Newton iteration with bisection if a step leaves the bracket.
double root_in(const Polynomial& p, int degree, double low, double high) {
  const bool rising = evaluate(p, degree, low).value < 0;
  double z = 0.5 * (low + high);
  for (int i = 0; i < 60; ++i) {
    const auto [value, slope] = evaluate(p, degree, z);
    if (value == 0) return z;
    ((value < 0) == rising ? low : high) = z;
    double next = z - value / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - z) <= 1e-15 * std::abs(z)) return next;
    z = next;
  }
  return z;
}

struct RootInterval {
  double low, high;
  int changes_low, changes_high;
};

// Geometric mean for large intervals: equal effort for roots of all magnitudes.
double middle_of(double low, double high) {
  if (low < 0 && high > 0) return 0;
  const double a = std::abs(low), b = std::abs(high);
  const double smaller = std::max(std::min(a, b), 1e-6 * std::max(a, b));
  if (std::max(a, b) < 4 * smaller) return 0.5 * (low + high);
  return std::copysign(std::sqrt(smaller * std::max(a, b)), low + high);
}

}  // namespace

RealRoots real_roots(const Polynomial& ascending) {
  RealRoots found;
  double largest = 0;
  for (const double c : ascending) largest = std::max(largest, std::abs(c));
  if (!(largest > 0) || !std::isfinite(largest)) return found;
  int degree = kMaxDegree;
  while (degree > 0 && std::abs(ascending[degree]) <= 1e-14 * largest) --degree;
  if (degree == 0) return found;
  Polynomial p{};
  double bound = 0;
  for (int i = 0; i <= degree; ++i) {
    p[i] = ascending[i] / ascending[degree];
    // Fujiwara's bound on the size of a root
    if (i < degree) bound = std::max(bound, std::pow(std::abs(p[i]), 1.0 / (degree - i)));
  }
  bound = 2 * bound + 1e-12;
  const SturmChain chain(p, degree);

  std::array<RootInterval, 64> open{};
  int pending = 0;
  open[pending++] = {-bound, bound, chain.sign_changes(-bound), chain.sign_changes(bound)};
  while (pending > 0 && found.count < degree) {
    const RootInterval at = open[--pending];
    const int roots = at.changes_low - at.changes_high;
    if (roots <= 0) continue;
    const double middle = middle_of(at.low, at.high);
    const bool narrow = at.high - at.low < 1e-13 * std::max(1e-3, std::abs(middle));
    if (narrow) {
      found.root[found.count++] = middle;
      continue;
    }
    if (roots == 1 &&
        (evaluate(p, degree, at.low).value < 0) != (evaluate(p, degree, at.high).value < 0)) {
      found.root[found.count++] = root_in(p, degree, at.low, at.high);
      continue;
    }
    if (pending + 2 > static_cast<int>(open.size())) break;
    const int changes = chain.sign_changes(middle);
    open[pending++] = {at.low, middle, at.changes_low, changes};
    open[pending++] = {middle, at.high, changes, at.changes_high};
  }
  std::sort(found.root.begin(), found.root.begin() + found.count);
  return found;
}

}  // namespace stillkite
