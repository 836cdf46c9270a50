#pragma once

#include <optional>
#include <span>

namespace stillkite {

/// A mean and its two-sided 95 % confidence interval, in the unit of the samples.
struct MeanInterval {
  int samples = 0;
  double mean = 0;
  double low = 0;
  double high = 0;
  bool is_reliable = true;  ///< false: they hang together for too long, the interval is too short
};

/// Of independent samples, such as the trials of several seeds: Student's t. Nothing of less than
/// two.
[[nodiscard]] std::optional<MeanInterval> independent_mean_interval(
    std::span<const double> samples);

/// Of samples that are correlated in time, such as the frames of one flight, by the method of batch
/// means: ten stretches one after the other, whose means are nearly independent where a stretch is
/// many times as long as the correlation, and Student's t of these (Schmeiser, Operations Research
/// 30(3), 1982: ten to thirty of them). Not reliable where von Neumann's ratio says that the means
/// of neighbouring stretches, half as long, are alike (one-sided 5 %; Young, Annals of Mathematical
/// Statistics 12(3), 1941): the samples drift like a random walk, and a flight is but one of them.
/// Nothing of less than twenty.
[[nodiscard]] std::optional<MeanInterval> correlated_mean_interval(std::span<const double> samples);

/// The interval is reliable and leaves zero out.
[[nodiscard]] bool differs_from_zero(const MeanInterval& interval);

}  // namespace stillkite
