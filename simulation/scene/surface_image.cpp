#include "simulation/scene/surface_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "simulation/random.hpp"
#include "simulation/scene/fractal_noise.hpp"

namespace stillkite {
namespace {

constexpr int kFractionBits = 4;  // of a drawn point's coordinates

cv::Point fine_point(double x, double y) {
  return {static_cast<int>(std::lround(x * (1 << kFractionBits))),
          static_cast<int>(std::lround(y * (1 << kFractionBits)))};
}

// Every other row of tiles is shifted by half a tile (running bond).
cv::Mat tiled(const SurfaceStyle& style, int width, int height, std::uint64_t seed) {
  cv::Mat offset(height, width, CV_32FC1, cv::Scalar(0));
  Random random(seed, 10);
  for (int row = 0; row * style.tile_height < height; ++row) {
    const int shift = row % 2 * style.tile_width / 2;
    for (int column = 0; column * style.tile_width < width + shift; ++column) {
      const cv::Rect tile(column * style.tile_width - shift, row * style.tile_height,
                          style.tile_width, style.tile_height);
      const cv::Scalar grey(style.tile_grey * random.normal());
      cv::rectangle(offset, tile, grey, cv::FILLED);
      cv::rectangle(offset, tile, cv::Scalar(style.joint_grey), 1);
    }
  }
  return offset;
}

// Filled rectangle at a random angle with up to three bars of another grey.
void draw_label(cv::Mat& image, double grey, double size, Random& random) {
  const double angle_rad =
      random.uniform() < 0.6 ? 0.05 * random.normal() : random.uniform(0, std::numbers::pi);
  const double half_length = 0.5 * size * random.uniform(0.7, 2);
  const double half_width = 0.5 * size * random.uniform(0.3, 1);
  const double x = random.uniform(0, image.cols);
  const double y = random.uniform(0, image.rows);
  const auto bar = [&](double from, double to, double share, double bar_grey) {
    const auto corner = [&](double along, double across) {
      return fine_point(x + along * std::cos(angle_rad) - across * std::sin(angle_rad),
                        y + along * std::sin(angle_rad) + across * std::cos(angle_rad));
    };
    const std::array<cv::Point, 4> corners{corner(-share * half_length, from * half_width),
                                           corner(share * half_length, from * half_width),
                                           corner(share * half_length, to * half_width),
                                           corner(-share * half_length, to * half_width)};
    cv::fillConvexPoly(image, corners.data(), 4, cv::Scalar(bar_grey), cv::LINE_AA, kFractionBits);
  };
  bar(-1, 1, 1, grey);
  if (size < 10) return;
  const double ink = grey > 128 ? grey - random.uniform(40, 90) : grey + random.uniform(40, 90);
  const int lines = 1 + static_cast<int>(random.uniform(0, 3));
  for (int line = 0; line < lines; ++line) {
    const double middle = (line + 1.0) / (lines + 1) * 2 - 1;
    bar(middle - 0.12, middle + 0.12, random.uniform(0.3, 0.85), ink);
  }
}

}  // namespace

cv::Mat surface_image(const SurfaceStyle& style, int width, int height, std::uint64_t seed) {
  const cv::Mat grain = fractal_noise(width, height, seed);
  cv::Mat image;
  if (style.tile_width > 0 && style.tile_height > 0) {
    cv::Mat surface;
    cv::scaleAdd(grain, style.grain_grey, tiled(style, width, height, seed), surface);
    surface.convertTo(image, CV_8UC1, 1, style.grey);
  } else {
    grain.convertTo(image, CV_8UC1, style.grain_grey, style.grey);
  }
  Random random(seed, 11);
  const auto marks =
      static_cast<int>(style.marks_a_megatexel * 1e-6 * static_cast<double>(image.total()));
  for (int mark = 0; mark < marks; ++mark) {
    const double size = style.mark_size * 0.4 / (1.05 - random.uniform());
    const double grey = style.grey + style.mark_grey * random.uniform(-1, 1);
    draw_label(image, std::clamp(grey, 5.0, 250.0), std::min(size, 8 * style.mark_size), random);
  }
  return image;
}

}  // namespace stillkite
