#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace stillkite {

/// How an image becomes grey bytes: gain x, then noise of that many grey values, then rounding.
struct Exposure {
  double gain = 1;
  double noise_grey = 0;
};

/// CV_8UC1 from a noise-free CV_32FC1 image. The noise is nearly Gaussian (the sum of eight
/// uniforms: within 3.5 sigma of it, then tails end) and independent between pixels, and between
/// images of different `seed`; it depends on nothing but the seed and the pixel.
[[nodiscard]] cv::Mat develop(const cv::Mat& irradiance, const Exposure& exposure,
                              std::uint64_t seed);

}  // namespace stillkite
