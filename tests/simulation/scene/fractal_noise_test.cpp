#include "simulation/scene/fractal_noise.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace stillkite {
namespace {

// Octaves with cells of 2, 4, ... 512 texels; amplitude 0.7 for the finest, 1 for the others.
TEST(FractalNoise, EqualsSumOfOctaves) {
  for (const cv::Size size : {cv::Size(301, 77), cv::Size(16, 700)}) {
    cv::Mat sum(size, CV_32FC1, cv::Scalar(0));
    for (int cell = 2, level = 1; cell <= 512; cell *= 2, ++level) {
      sum += (cell == 2 ? 0.7 : 1.0) * lattice_noise(size.width, size.height, cell,
                                                     Random(9, static_cast<std::uint64_t>(level)));
    }
    EXPECT_LT(cv::norm(fractal_noise(size.width, size.height, 9), sum, cv::NORM_INF), 1e-5);
  }
}

}  // namespace
}  // namespace stillkite
