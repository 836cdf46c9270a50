#include "geometry/chi_square.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

namespace stillkite {
namespace {

constexpr double kPrecision = 1e-15;
constexpr int kMaxTerms = 100000;

/// x^a e^-x / Gamma(a + 1), the factor before both expansions of P(a, x).
double prefactor(double a, double x) {
  return std::exp(a * std::log(x) - x - std::lgamma(a + 1));
}

/// P(a, x) by its power series, for x < a + 1 (Abramowitz & Stegun 6.5.29).
double lower_by_series(double a, double x) {
  double term = 1;
  double sum = 1;
  for (int n = 1; n < kMaxTerms && term > kPrecision * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return prefactor(a, x) * sum;
}

/// 1 - P(a, x) by its continued fraction, for x >= a + 1 (Abramowitz & Stegun 6.5.31, evaluated
/// by Lentz's method).
double upper_by_fraction(double a, double x) {
  double b = x + 1 - a;
  double c = 1 / 1e-300;
  double d = 1 / b;
  double value = d;
  for (int n = 1; n < kMaxTerms; ++n) {
    const double an = -n * (n - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    value *= c * d;
    if (std::abs(c * d - 1) < kPrecision) break;
  }
  return prefactor(a, x) * a * value;
}

/// 1 - P(dof/2, x/2), without cancellation where it is small.
double upper_tail(double x, double dof) {
  const double a = 0.5 * dof;
  const double half_x = 0.5 * x;
  return half_x < a + 1 ? 1 - lower_by_series(a, half_x) : upper_by_fraction(a, half_x);
}

}  // namespace

double chi_square_cdf(double x, double dof) {
  assert(dof > 0);
  if (x <= 0) return 0;
  const double a = 0.5 * dof;
  const double half_x = 0.5 * x;
  return half_x < a + 1 ? lower_by_series(a, half_x) : 1 - upper_by_fraction(a, half_x);
}

double chi_square_quantile(double probability, double dof) {
  assert(probability > 0 && probability < 1);
  double low = 0;
  double high = dof + 1;
  while (chi_square_cdf(high, dof) < probability) high *= 2;
  while (high - low > 1e-12 * high) {
    const double middle = 0.5 * (low + high);
    (chi_square_cdf(middle, dof) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double chi_square_at_sigmas(double sigmas, double dof) {
  assert(sigmas > 0 && dof > 0);
  const double tail = std::erfc(sigmas / std::numbers::sqrt2);
  double low = 0;
  double high = dof + 1;
  while (upper_tail(high, dof) > tail) high *= 2;
  while (high - low > 1e-12 * high) {
    const double middle = 0.5 * (low + high);
    (upper_tail(middle, dof) > tail ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace stillkite
