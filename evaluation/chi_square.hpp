#pragma once

namespace stillkite {

/// P(X <= x) of a chi-square variable: regularized lower gamma function P(dof/2, x/2); dof > 0.
[[nodiscard]] double chi_square_cdf(double x, double dof);

/// Inverse of chi_square_cdf; probability in (0, 1).
[[nodiscard]] double chi_square_quantile(double probability, double dof);

}  // namespace stillkite
