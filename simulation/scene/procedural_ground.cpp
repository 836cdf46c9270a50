#include "simulation/scene/procedural_ground.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "simulation/random.hpp"
#include "simulation/scene/fractal_noise.hpp"

namespace stillkite {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

struct Field {
  float x, y;
  float grey;
  float furrow_x, furrow_y, furrow_depth;  // wave vector in rad a texel
};

// Voronoi cells with distorted borders; grey value and furrows per cell, hedges between cells.
void plough_fields(cv::Mat& ground, std::uint64_t seed) {
  constexpr int kFieldSize = 190;
  constexpr float kHedgeWidth = 3.0F;
  Random random(seed, 100);
  const int columns = ground.cols / kFieldSize + 3;
  const int rows = ground.rows / kFieldSize + 3;
  std::vector<Field> fields;
  for (int k = 0; k < rows * columns; ++k) {
    const int column = k % columns - 1;
    const int row = k / columns - 1;
    const double direction = random.uniform(0, kTwoPi);
    const double wave = kTwoPi / random.uniform(5, 18);
    const double depth = random.uniform() < 0.6 ? random.uniform(2, 12) : 0.0;
    const double x = (column + random.uniform()) * kFieldSize;
    const double y = (row + random.uniform()) * kFieldSize;
    fields.push_back({.x = static_cast<float>(x),
                      .y = static_cast<float>(y),
                      .grey = static_cast<float>(24 * random.normal()),
                      .furrow_x = static_cast<float>(wave * std::cos(direction)),
                      .furrow_y = static_cast<float>(wave * std::sin(direction)),
                      .furrow_depth = static_cast<float>(depth)});
  }
  const cv::Mat bend_x = lattice_noise(ground.cols, ground.rows, 64, Random(seed, 101));
  const cv::Mat bend_y = lattice_noise(ground.cols, ground.rows, 64, Random(seed, 102));
  for (int row = 0; row < ground.rows; ++row) {
    for (int column = 0; column < ground.cols; ++column) {
      const float x = static_cast<float>(column) + 14 * bend_x.at<float>(row, column);
      const float y = static_cast<float>(row) + 14 * bend_y.at<float>(row, column);
      const int cell_x = std::clamp(column / kFieldSize + 1, 1, columns - 2);
      const int cell_y = std::clamp(row / kFieldSize + 1, 1, rows - 2);
      const Field* nearest = nullptr;
      float first = 1e18F;
      float second = 1e18F;
      for (int k = 0; k < 9; ++k) {
        const Field& field = fields[(cell_y + k / 3 - 1) * columns + cell_x + k % 3 - 1];
        const float squared_distance =
            (x - field.x) * (x - field.x) + (y - field.y) * (y - field.y);
        if (squared_distance < first) {
          second = first;
          first = squared_distance;
          nearest = &field;
        } else {
          second = std::min(second, squared_distance);
        }
      }
      const float phase = nearest->furrow_x * x + nearest->furrow_y * y;
      const float hedge =
          std::clamp(kHedgeWidth - 0.5F * (std::sqrt(second) - std::sqrt(first)), 0.0F, 1.0F);
      const float furrow = nearest->furrow_depth > 0 ? std::sin(phase) : 0.0F;
      const float field_grey = nearest->grey + nearest->furrow_depth * furrow;
      ground.at<float>(row, column) += (1 - hedge) * field_grey - hedge * 35;
    }
  }
}

void lay_paths(cv::Mat& ground, std::uint64_t seed) {
  Random random(seed, 200);
  const int paths = std::max(2, static_cast<int>(ground.total() / 400000));
  cv::Mat cover(ground.size(), CV_8UC1, cv::Scalar(0));
  for (int path = 0; path < paths; ++path) {
    double x = random.uniform(0, ground.cols);
    double y = random.uniform(0, ground.rows);
    double heading = random.uniform(0, kTwoPi);
    std::vector<cv::Point> points;
    constexpr int kShift = 4;  // fractional bits of a drawn point
    for (int step = 0; step < 150; ++step) {
      points.emplace_back(static_cast<int>(x * (1 << kShift)), static_cast<int>(y * (1 << kShift)));
      heading += 0.12 * random.normal();
      x += 14 * std::cos(heading);
      y += 14 * std::sin(heading);
    }
    const int thickness = 2 + static_cast<int>(random.uniform(0, 6));
    cv::polylines(cover, points, false, cv::Scalar(255), thickness, cv::LINE_AA, kShift);
  }
  for (int row = 0; row < ground.rows; ++row) {
    for (int column = 0; column < ground.cols; ++column) {
      const float share = static_cast<float>(cover.at<std::uint8_t>(row, column)) / 255.0F;
      float& grey = ground.at<float>(row, column);
      grey += share * (60 - 0.7F * grey);
    }
  }
}

// Disc with an antialiased edge of one texel, blended over the ground.
void paint_disc(cv::Mat& ground, double x, double y, double radius, float grey, float opacity) {
  const int left = std::max(0, static_cast<int>(x - radius - 1));
  const int right = std::min(ground.cols - 1, static_cast<int>(x + radius + 2));
  const int top = std::max(0, static_cast<int>(y - radius - 1));
  const int bottom = std::min(ground.rows - 1, static_cast<int>(y + radius + 2));
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      const double inside = radius + 0.5 - std::hypot(column - x, row - y);
      float& below = ground.at<float>(row, column);
      below += opacity * static_cast<float>(std::clamp(inside, 0.0, 1.0)) * (grey - below);
    }
  }
}

void scatter(cv::Mat& ground, std::uint64_t seed) {
  Random random(seed, 300);
  const auto bushes = static_cast<int>(ground.total() / 2500);
  for (int bush = 0; bush < bushes; ++bush) {
    const double x = random.uniform(0, ground.cols);
    const double y = random.uniform(0, ground.rows);
    const double radius = 1.5 / (1.0 - 0.9 * random.uniform());  // many small, few large
    const float grey = static_cast<float>(random.uniform(-70, -10));
    paint_disc(ground, x + 0.5 * radius, y + 0.4 * radius, radius, -90, 0.8F);  // shadow
    paint_disc(ground, x, y, radius, grey, 0.95F);
    paint_disc(ground, x - 0.3 * radius, y - 0.3 * radius, 0.4 * radius, grey + 35, 0.7F);
  }
  const auto stones = static_cast<int>(ground.total() / 500);
  for (int stone = 0; stone < stones; ++stone) {
    const double x = random.uniform(0, ground.cols);
    const double y = random.uniform(0, ground.rows);
    const float grey = static_cast<float>(random.uniform() < 0.7 ? 85 : -85);
    paint_disc(ground, x, y, random.uniform(0.4, 1.6), grey, 0.9F);
  }
}

}  // namespace

cv::Mat procedural_ground(int width, int height, std::uint64_t seed) {
  constexpr double kOctaveDeviation = 17;
  constexpr double kMiddleGrey = 122;
  cv::Mat ground = fractal_noise(width, height, seed) * kOctaveDeviation;
  plough_fields(ground, seed);
  lay_paths(ground, seed);
  scatter(ground, seed);
  cv::Mat grey;
  ground.convertTo(grey, CV_8UC1, 0.8, kMiddleGrey);
  return grey;
}

cv::Mat repetitive_ground(const cv::Mat& image, int period, int max_side) {
  CV_Assert(image.type() == CV_8UC1 && period >= 4 && period % 2 == 0);
  const int half = period / 2;
  CV_Assert(image.cols > half && image.rows > half);
  const int side = std::max(1, (max_side - 1) / half) * half + 1;
  const auto folded = [&](int texel) {
    const int within = texel % period;
    return std::min(within, period - within);
  };
  cv::Mat ground(side, side, CV_8UC1);
  for (int row = 0; row < side; ++row) {
    const std::uint8_t* from = image.ptr(folded(row));
    std::uint8_t* to = ground.ptr(row);
    for (int column = 0; column < side; ++column) to[column] = from[folded(column)];
  }
  return ground;
}

}  // namespace stillkite
