#pragma once

#include <array>

namespace stillkite {

inline constexpr int kMaxDegree = 10;

/// Coefficients in ascending order: c[0] + c[1] z + ... + c[10] z^10.
using Polynomial = std::array<double, kMaxDegree + 1>;

struct RealRoots {
  std::array<double, kMaxDegree> root{};
  int count = 0;
};

/// Distinct real roots of a polynomial of degree <= 10, ascending. Sturm's theorem isolates the
/// roots, bracketed Newton iteration refines them. No roots if a coefficient is not finite. Source:
/// Nister 2004, "An efficient solution to the five-point relative pose problem", section 3.2.3.
[[nodiscard]] RealRoots real_roots(const Polynomial& ascending);

}  // namespace stillkite
