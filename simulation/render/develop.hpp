#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace stillkite {

/// Sensor model: grey = round(signal + noise), clipped to [0, 255], with signal = gain x irradiance
/// and the noise variance noise_grey^2 + photon_variance_per_grey x signal.
struct Exposure {
  double gain = 1;
  double noise_grey = 0;  ///< standard deviation, in grey values
  double photon_variance_per_grey = 0;
};

/// Camera development: applies gain, noise and quantisation to a noise-free CV_32FC1 image; returns
/// CV_8UC1. The noise is a sum of eight uniform bytes: Gaussian within 3.5 sigma, then truncated.
/// It depends only on the seed and the pixel; pixels and seeds are independent.
[[nodiscard]] cv::Mat develop(const cv::Mat& irradiance, const Exposure& exposure,
                              std::uint64_t seed);

}  // namespace stillkite
