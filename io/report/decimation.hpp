#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace stillkite {

/// Decimation for drawing to at most `max_samples` (even) values: minimum and maximum of equal
/// intervals, in their order; NaN twice for an interval without a number. Shorter series are
/// returned unchanged. Series of equal length use the same intervals, so samples stay aligned.
[[nodiscard]] std::vector<float> keep_extremes(std::span<const float> values,
                                               std::size_t max_samples);

/// At most `max_samples` values, evenly spaced, first and last included.
[[nodiscard]] std::vector<float> keep_every_nth(std::span<const float> values,
                                                std::size_t max_samples);

}  // namespace stillkite
