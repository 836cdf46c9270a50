#include "evaluation/student_t.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

namespace stillkite {

double student_t_probability(double t, int degrees_of_freedom) {
  assert(t >= 0 && degrees_of_freedom >= 1);
  const double dof = degrees_of_freedom;
  const double angle_rad = std::atan(t / std::sqrt(dof));
  const double cos_squared = dof / (dof + t * t);
  const bool is_odd = degrees_of_freedom % 2 == 1;
  // odd: 1 + 2/3 c^2 + (2 4)/(3 5) c^4 ...; even: 1 + 1/2 c^2 + (1 3)/(2 4) c^4 ...; up to
  // c^(dof-2)
  double term = 1;
  double sum = 0;
  for (int k = is_odd ? 3 : 2; k <= degrees_of_freedom; k += 2) {
    sum += term;
    term *= cos_squared * (k - 1) / k;
  }
  if (!is_odd) return std::sin(angle_rad) * sum;
  return 2 / std::numbers::pi * (angle_rad + std::sin(angle_rad) * std::cos(angle_rad) * sum);
}

double student_t_two_sided_quantile(double confidence, int degrees_of_freedom) {
  assert(confidence > 0 && confidence < 1);
  double low = 0;
  double high = 1;
  while (student_t_probability(high, degrees_of_freedom) < confidence) high *= 2;
  while (high - low > 1e-12 * high) {
    const double middle = 0.5 * (low + high);
    (student_t_probability(middle, degrees_of_freedom) < confidence ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace stillkite
