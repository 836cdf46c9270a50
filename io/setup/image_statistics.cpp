#include "io/setup/image_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "flow/image_mask.hpp"
#include "flow/pyramid.hpp"
#include "navigation/image_texture.hpp"

namespace stillkite {
namespace {

constexpr int kRowStep = 4;
constexpr int kGreyMargin = 2;

const std::uint8_t* mask_row(const Frame& frame, int row) {
  return frame.mask ? frame.mask->valid_pixels().ptr<std::uint8_t>(row) : nullptr;
}

double square_of(int value) {
  return static_cast<double>(value) * value;
}

// Level that the ratio of pixels at or below it reaches.
int quantile(const std::array<std::int64_t, 256>& histogram, double ratio) {
  std::int64_t total = 0;
  for (const std::int64_t count : histogram) total += count;
  std::int64_t sum = 0;
  for (int level = 0; level < 256; ++level) {
    sum += histogram[static_cast<std::size_t>(level)];
    if (static_cast<double>(sum) >= ratio * static_cast<double>(total)) return level;
  }
  return 255;
}

double ratio_between(const std::array<std::int64_t, 256>& histogram, int low, int high) {
  std::int64_t inside = 0, total = 0;
  for (int level = 0; level < 256; ++level) {
    const std::int64_t count = histogram[static_cast<std::size_t>(level)];
    total += count;
    if (level >= low && level <= high) inside += count;
  }
  return total == 0 ? 0 : static_cast<double>(inside) / static_cast<double>(total);
}

}  // namespace

void ImageStatistics::add(const Frame& frame) {
  constexpr int kReach = 4;  // px, of the structure function
  const cv::Mat& grey = frame.grey;
  for (int row = kReach; row + kReach < grey.rows; row += kRowStep) {
    const auto* here = grey.ptr<std::uint8_t>(row);
    const auto* below2 = grey.ptr<std::uint8_t>(row + 2);
    const auto* below4 = grey.ptr<std::uint8_t>(row + kReach);
    const std::uint8_t* valid = mask_row(frame, row);
    for (int x = 0; x + kReach < grey.cols; ++x) {
      if (valid != nullptr && valid[x] == 0) continue;
      ++histogram_[here[x]];
      structure2_ += square_of(here[x + 2] - here[x]) + square_of(below2[x] - here[x]);
      structure4_ += square_of(here[x + kReach] - here[x]) + square_of(below4[x] - here[x]);
      ++pixels_;
    }
  }
  Pyramid pyramid;
  pyramid.build(grey, 3);
  textured_sum_ += stillkite::textured_ratio(texture_level(pyramid));
  ++frames_;
}

double ImageStatistics::saturated_ratio() const {
  constexpr double kQuantile = 0.999;
  constexpr int kMinBright = 200;
  const int brightest = quantile(histogram_, kQuantile);
  return brightest < kMinBright ? 0 : ratio_between(histogram_, brightest - kGreyMargin, 255);
}

double ImageStatistics::dark_ratio() const {
  constexpr double kQuantile = 0.001;
  constexpr int kMaxDark = 40;
  const int darkest = quantile(histogram_, kQuantile);
  return darkest > kMaxDark ? 0 : ratio_between(histogram_, 0, darkest + kGreyMargin);
}

double ImageStatistics::blur_px() const {
  constexpr double kSmooth = 4 - 1e-6;  // of a linear image
  if (!(structure2_ > 0)) return kMaxBlur_px;
  const double ratio = structure4_ / structure2_;
  if (ratio >= kSmooth) return kMaxBlur_px;
  // D(4) / D(2) = 1 + q, 1 + q + q^2 + q^3 with q = exp(-1 / sigma^2): (1 - q^4) / (1 - q)
  double low = 0, high = kMaxBlur_px;
  for (int i = 0; i < 50; ++i) {
    const double sigma = 0.5 * (low + high);
    const double q = std::exp(-1 / (sigma * sigma));
    (1 + q + q * q + q * q * q < ratio ? low : high) = sigma;
  }
  return 0.5 * (low + high);
}

double ImageStatistics::textured_ratio() const {
  return frames_ == 0 ? 0 : textured_sum_ / frames_;
}

ImageGradients ImageStatistics::gradients(const Frame& frame) {
  ImageGradients out;
  const cv::Mat& grey = frame.grey;
  for (int row = 1; row + 1 < grey.rows; row += kRowStep) {
    const auto* above = grey.ptr<std::uint8_t>(row - 1);
    const auto* here = grey.ptr<std::uint8_t>(row);
    const auto* below = grey.ptr<std::uint8_t>(row + 1);
    const std::uint8_t* valid = mask_row(frame, row);
    for (int x = 1; x + 1 < grey.cols; ++x) {
      if (valid != nullptr && valid[x] == 0) continue;
      const double ix = 0.5 * (here[x + 1] - here[x - 1]);
      const double iy = 0.5 * (below[x] - above[x]);
      const double ixx = here[x + 1] - 2 * here[x] + here[x - 1];
      const double iyy = below[x] - 2 * here[x] + above[x];
      const double ixy = 0.25 * (below[x + 1] - below[x - 1] - above[x + 1] + above[x - 1]);
      const Eigen::Vector2d g(ix, iy);
      const Eigen::Vector3d h(ixx, 2 * ixy, iyy);
      out.first += g * g.transpose();
      out.second += h * h.transpose();
    }
  }
  return out;
}

}  // namespace stillkite
