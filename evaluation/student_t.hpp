#pragma once

namespace stillkite {

/// P(|T| <= t) of Student's t distribution, by the finite sums of Abramowitz & Stegun (1964),
/// 26.7.3 and 26.7.4. t >= 0, degrees_of_freedom >= 1.
[[nodiscard]] double student_t_probability(double t, int degrees_of_freedom);

/// The t with P(|T| <= t) = confidence, in (0, 1): a two-sided interval reaches that many standard
/// errors to either side.
[[nodiscard]] double student_t_reach(double confidence, int degrees_of_freedom);

}  // namespace stillkite
