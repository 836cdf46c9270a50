#include "navigation/image_texture.hpp"

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>

namespace stillkite {
namespace {

constexpr int kBlock_px = 12;

// Mean squared central difference of a block, (2 grey/px)^2: four times the residue of noise with
// sigma 2 grey on the third pyramid level.
constexpr int kMinGradientEnergy = 4;

std::int64_t squared_differences(const cv::Mat& grey, int top, int left) {
  std::int64_t sum = 0;
  for (int row = top; row < top + kBlock_px; ++row) {
    const auto* above = grey.ptr<std::uint8_t>(row - 1);
    const auto* here = grey.ptr<std::uint8_t>(row);
    const auto* below = grey.ptr<std::uint8_t>(row + 1);
    for (int column = left; column < left + kBlock_px; ++column) {
      const int across = here[column + 1] - here[column - 1];
      const int down = below[column] - above[column];
      sum += across * across + down * down;
    }
  }
  return sum;
}

}  // namespace

double textured_ratio(const cv::Mat& grey) {
  int blocks = 0;
  int textured = 0;
  for (int top = 1; top + kBlock_px < grey.rows; top += kBlock_px) {
    for (int left = 1; left + kBlock_px < grey.cols; left += kBlock_px) {
      ++blocks;
      const std::int64_t sum = squared_differences(grey, top, left);
      textured += sum > 2 * kMinGradientEnergy * kBlock_px * kBlock_px ? 1 : 0;
    }
  }
  return blocks == 0 ? 0.0 : static_cast<double>(textured) / blocks;
}

const cv::Mat& texture_level(const Pyramid& pyramid) {
  constexpr int kLevel = 2;
  return pyramid.level(std::min(kLevel, pyramid.levels() - 1));
}

}  // namespace stillkite
