#include "simulation/render/develop.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "simulation/random.hpp"
#include "simulation/render/develop_kernel.hpp"

namespace stillkite {

cv::Mat develop(const cv::Mat& irradiance, const Exposure& exposure, std::uint64_t seed) {
  CV_Assert(irradiance.type() == CV_32FC1);
  const std::uint64_t key = mix_bits(seed);
  const int padded = (irradiance.cols + kDevelopPadding - 1) / kDevelopPadding * kDevelopPadding;
  std::vector<float> in(padded, 0.0F);
  std::vector<std::uint8_t> out(padded);
  cv::Mat image(irradiance.size(), CV_8UC1);
  for (int row = 0; row < irradiance.rows; ++row) {
    std::copy_n(irradiance.ptr<float>(row), irradiance.cols, in.data());
    develop_row(
        {.irradiance = in.data(),
         .grey = out.data(),
         .count = padded,
         .first_pixel = static_cast<std::uint32_t>(row) * padded,
         .key_1 = static_cast<std::uint32_t>(key),
         .key_2 = static_cast<std::uint32_t>(key >> 32),
         .gain = static_cast<float>(exposure.gain),
         .noise_grey = static_cast<float>(exposure.noise_grey),
         .photon_variance_per_grey = static_cast<float>(exposure.photon_variance_per_grey)});
    std::copy_n(out.data(), irradiance.cols, image.ptr(row));
  }
  return image;
}

}  // namespace stillkite
