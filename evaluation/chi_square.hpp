#pragma once

namespace stillkite {

/// P(X <= x) of a chi-square variable: the regularised lower gamma function P(dof/2, x/2).
/// dof > 0.
[[nodiscard]] double chi_square_cdf(double x, double dof);

/// The x with chi_square_cdf(x, dof) = probability, in (0, 1).
[[nodiscard]] double chi_square_quantile(double probability, double dof);

}  // namespace stillkite
