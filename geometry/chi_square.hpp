#pragma once

namespace stillkite {

/// P(X <= x) of a chi-square variable: regularized lower gamma function P(dof/2, x/2); dof > 0.
[[nodiscard]] double chi_square_cdf(double x, double dof);

/// Inverse of chi_square_cdf; probability in (0, 1).
[[nodiscard]] double chi_square_quantile(double probability, double dof);

/// Squared error whose square root is `sigmas` standard deviations: exceeded as rarely as a normal
/// variable differs from its mean by more than `sigmas` > 0. sigmas^2 for dof = 1; at most 1400.
[[nodiscard]] double chi_square_at_sigmas(double sigmas, double dof);

/// Medians, by degrees of freedom, for robust estimates of a variance.
inline constexpr double kChiSquareMedian1 = 0.4549;
inline constexpr double kChiSquareMedian2 = 1.3862943611198906;  ///< 2 ln 2

/// Quantiles of 1 - 3e-7 (one-sided five sigma), rounded down, by degrees of freedom, for tests.
inline constexpr double kChiSquareFiveSigma3 = 33;
inline constexpr double kChiSquareFiveSigma5 = 38;

}  // namespace stillkite
