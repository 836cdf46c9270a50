#pragma once

#include <optional>
#include <span>

namespace stillkite {

/// Mean and two-sided 95 % confidence interval, in the unit of the samples.
struct MeanInterval {
  int samples = 0;
  double mean = 0;
  double low = 0;
  double high = 0;
  bool is_reliable = true;  ///< false: correlation too long, interval too short
};

/// Student's t interval of independent samples, such as trials of several seeds. std::nullopt below
/// 2 samples.
[[nodiscard]] std::optional<MeanInterval> independent_mean_interval(
    std::span<const double> samples);

/// Batch-means interval of samples that are correlated in time, such as the frames of one flight:
/// Student's t of the means of 10 consecutive batches, which are nearly independent if a batch is
/// much longer than the correlation time (Schmeiser, Operations Research 30(3), 1982: 10 to 30
/// batches). Not reliable if von Neumann's ratio of 20 batch means rejects independence (one-sided
/// 5 %; Young, Annals of Mathematical Statistics 12(3), 1941), as for a random walk. std::nullopt
/// below 20 samples.
[[nodiscard]] std::optional<MeanInterval> correlated_mean_interval(std::span<const double> samples);

/// True if the interval is reliable and excludes zero.
[[nodiscard]] bool differs_from_zero(const MeanInterval& interval);

/// P(|T| <= t) of Student's t distribution, by the finite sums of Abramowitz & Stegun (1964),
/// 26.7.3 and 26.7.4. t >= 0, degrees_of_freedom >= 1.
[[nodiscard]] double student_t_probability(double t, int degrees_of_freedom);

/// Two-sided quantile: t with P(|T| <= t) = confidence, in (0, 1). Half width of a confidence
/// interval in standard errors.
[[nodiscard]] double student_t_two_sided_quantile(double confidence, int degrees_of_freedom);

}  // namespace stillkite
