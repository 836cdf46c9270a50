#include "simulation/scene/ground_texture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

// Appends the pairs of one level; mirrored beyond the last column and row.
void append_pairs(const cv::Mat& grey, int pitch, std::vector<std::uint8_t>& pairs) {
  const std::size_t first = pairs.size();
  pairs.resize(first + std::size_t{2} * pitch * grey.rows);
  std::uint8_t* pair = &pairs[first];
  for (int v = 0; v < grey.rows; ++v, pair += std::ptrdiff_t{2} * pitch) {
    const std::uint8_t* here = grey.ptr(v);
    const std::uint8_t* below = grey.ptr(v + 1 < grey.rows ? v + 1 : grey.rows - 2);
    for (int u = 0; u < grey.cols; ++u) {
      pair[2 * u] = here[u];
      pair[2 * u + 1] = below[u];
    }
    pair[2 * grey.cols] = here[grey.cols - 2];
    pair[2 * grey.cols + 1] = below[grey.cols - 2];
  }
}

// Smallest pitch of more than `width` pairs that is an odd number of cache lines.
int pitch_for(int width) {
  constexpr int kPairsPerLine = 32;
  return ((width + kPairsPerLine) / kPairsPerLine | 1) * kPairsPerLine;
}

// Reflection about the centres of the first and the last texel.
double fold(double u, int size) {
  const double period = 2.0 * (size - 1);
  return std::abs(u - period * std::nearbyint(u / period));
}

}  // namespace

GroundTexture::GroundTexture(const cv::Mat& grey, double metres_per_texel)
    : metres_per_texel_(metres_per_texel) {
  constexpr int kMinLevel_texels = 16;
  if (grey.type() != CV_8UC1 || grey.rows < 2 || grey.cols < 2 || grey.total() > 750000000u) {
    throw InputError("ground: the image has " + std::to_string(grey.cols) + "x" +
                     std::to_string(grey.rows) +
                     " pixels; convert or crop it to 8-bit grey of 2x2 to 7.5e8 pixels");
  }
  if (!(metres_per_texel > 0)) {
    throw InputError("ground: metres per texel must be > 0, not " +
                     std::to_string(metres_per_texel));
  }
  pairs_.reserve(grey.total() * 3 + 8192);
  cv::Mat level = grey;
  for (;;) {
    const int pitch = pitch_for(level.cols);
    levels_.push_back(
        {static_cast<std::int64_t>(pairs_.size() / 2), level.cols, level.rows, pitch});
    append_pairs(level, pitch, pairs_);
    if (std::min(level.cols, level.rows) < 2 * kMinLevel_texels) break;
    cv::Mat half;
    const cv::Mat even = level(cv::Rect(0, 0, level.cols / 2 * 2, level.rows / 2 * 2));
    cv::resize(even, half, even.size() / 2, 0, 0, cv::INTER_AREA);
    level = half;
  }
}

Eigen::Vector2d GroundTexture::texel_of(const Eigen::Vector2d& ground) const {
  return {ground.x() / metres_per_texel_ + 0.5 * (levels_[0].width - 1),
          -ground.y() / metres_per_texel_ + 0.5 * (levels_[0].height - 1)};
}

double GroundTexture::grey_at(const Eigen::Vector2d& ground) const {
  const Level& finest = levels_[0];
  const Eigen::Vector2d texel = texel_of(ground);
  const double u = fold(texel.x(), finest.width);
  const double v = fold(texel.y(), finest.height);
  const auto column = static_cast<std::int64_t>(u);
  const auto row = static_cast<std::int64_t>(v);
  const double a = u - static_cast<double>(column);
  const double b = v - static_cast<double>(row);
  const std::uint8_t* quad = &pairs_[2 * static_cast<std::size_t>(row * finest.pitch + column)];
  return (1 - b) * ((1 - a) * quad[0] + a * quad[2]) + b * ((1 - a) * quad[1] + a * quad[3]);
}

}  // namespace stillkite
