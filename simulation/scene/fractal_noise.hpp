#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "simulation/random.hpp"

namespace stillkite {

/// CV_32FC1: uniform random values in [-1, 1] on a lattice with a spacing of `cell` texels,
/// interpolated by cubic convolution.
[[nodiscard]] cv::Mat lattice_noise(int width, int height, int cell, const Random& generator);

/// CV_32FC1 with an amplitude spectrum of about 1/f: the sum of octaves of `lattice_noise` with
/// about equal variance.
[[nodiscard]] cv::Mat fractal_noise(int width, int height, std::uint64_t seed);

}  // namespace stillkite
