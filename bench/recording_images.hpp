#pragma once

#include <cstdint>

#include "recording.hpp"

namespace stillkite::bench {

/// Half resolution by the mean of 2x2 pixels.
[[nodiscard]] Recording half_size(const Recording& recording);

/// Grey value g' = 255 (g / 255)^gamma.
[[nodiscard]] Recording with_gamma(const Recording& recording, double gamma);

/// Independent Gaussian noise on each pixel, rounded and clipped.
[[nodiscard]] Recording with_noise(const Recording& recording, double sigma_grey,
                                   std::uint64_t seed);

/// Compressed as JPEG and decoded.
[[nodiscard]] Recording with_jpeg(const Recording& recording, int quality);

/// Gain that alternates between 1 and `low_gain` every second, or every sixth of a recording below
/// six seconds.
[[nodiscard]] Recording with_exposure_steps(const Recording& recording, double low_gain);

}  // namespace stillkite::bench
