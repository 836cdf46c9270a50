#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace stillkite {

/// At most `max_samples` of the values, for drawing: the values are cut into equal stretches and
/// of each stretch its smallest and its largest are kept, in the order in which they come. A
/// stretch without any number gives NaN twice. Short enough a series stays as it is. Series of
/// equal length are cut alike, so their samples still belong together. `max_samples` is even.
[[nodiscard]] std::vector<float> keep_extremes(std::span<const float> values,
                                               std::size_t max_samples);

/// At most `max_samples` values, evenly spread, the last one among them.
[[nodiscard]] std::vector<float> keep_every_nth(std::span<const float> values,
                                                std::size_t max_samples);

}  // namespace stillkite
