#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "simulation/random.hpp"

namespace stillkite {

/// CV_32FC1: random values in [-1, 1] on a lattice `cell` texels apart, joined by cubics.
[[nodiscard]] cv::Mat lattice_noise(int width, int height, int cell, const Random& start);

/// CV_32FC1 with an amplitude spectrum of about 1/f: every octave carries about the same variance,
/// that of a value within [-1, 1].
[[nodiscard]] cv::Mat fractal_noise(int width, int height, std::uint64_t seed);

}  // namespace stillkite
