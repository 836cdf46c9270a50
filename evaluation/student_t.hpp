#pragma once

namespace stillkite {

/// P(|T| <= t) of Student's t distribution, by the finite sums of Abramowitz & Stegun (1964),
/// 26.7.3 and 26.7.4. t >= 0, degrees_of_freedom >= 1.
[[nodiscard]] double student_t_probability(double t, int degrees_of_freedom);

/// Two-sided quantile: t with P(|T| <= t) = confidence, in (0, 1). Half width of a confidence
/// interval in standard errors.
[[nodiscard]] double student_t_two_sided_quantile(double confidence, int degrees_of_freedom);

}  // namespace stillkite
