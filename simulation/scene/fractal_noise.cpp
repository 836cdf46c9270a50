#include "simulation/scene/fractal_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace stillkite {
namespace {

cv::Mat random_lattice(int width, int height, int cell, const Random& generator) {
  Random random = generator;
  cv::Mat lattice(height / cell + 4, width / cell + 4, CV_32FC1);
  for (int row = 0; row < lattice.rows; ++row) {
    for (int column = 0; column < lattice.cols; ++column) {
      lattice.at<float>(row, column) = static_cast<float>(random.uniform(-1.0, 1.0));
    }
  }
  return lattice;
}

// Cubic convolution (Keys, 1981) with a = -3/4 as in OpenCV: weights of the four neighbours.
std::array<float, 4> cubic_weights(float fraction) {
  const auto outer = [](float x) { return -0.75F * (((x - 5) * x + 8) * x - 4); };
  const auto inner = [](float x) { return (1.25F * x - 2.25F) * x * x + 1; };
  return {outer(1 + fraction), inner(fraction), inner(1 - fraction), outer(2 - fraction)};
}

// Lattice interpolated along its rows only.
struct Octave {
  cv::Mat rows;
  int cell;
  float weight;
};

// Interpolates one row of an octave along the columns and adds it to `sum`.
void add_octave_row(const Octave& octave, int row, cv::Mat& sum) {
  const float at = (static_cast<float>(row) + 0.5F) / static_cast<float>(octave.cell) + 0.5F;
  const int first = static_cast<int>(at) - 1;
  std::array<float, 4> w = cubic_weights(at - std::floor(at));
  for (float& weight : w) weight *= octave.weight;
  const auto lattice_row = [&](int k) {
    return octave.rows.ptr<float>(std::clamp(first + k, 0, octave.rows.rows - 1)) + octave.cell;
  };
  const float* r0 = lattice_row(0);
  const float* r1 = lattice_row(1);
  const float* r2 = lattice_row(2);
  const float* r3 = lattice_row(3);
  auto* out = sum.ptr<float>(row);
  for (int x = 0; x < sum.cols; ++x) {
    out[x] += w[0] * r0[x] + w[1] * r1[x] + w[2] * r2[x] + w[3] * r3[x];
  }
}

}  // namespace

cv::Mat lattice_noise(int width, int height, int cell, const Random& generator) {
  const cv::Mat lattice = random_lattice(width, height, cell, generator);
  cv::Mat fine;
  cv::resize(lattice, fine, lattice.size() * cell, 0, 0, cv::INTER_CUBIC);
  return fine(cv::Rect(cell, cell, width, height)).clone();
}

cv::Mat fractal_noise(int width, int height, std::uint64_t seed) {
  std::vector<Octave> octaves;
  for (int cell = 2, level = 1; cell <= 512; cell *= 2, ++level) {
    const float amplitude = cell == 2 ? 0.7F : 1.0F;
    const cv::Mat lattice = random_lattice(width, height, cell, Random(seed, level));
    cv::Mat rows;
    cv::resize(lattice, rows, {lattice.cols * cell, lattice.rows}, 0, 0, cv::INTER_CUBIC);
    octaves.push_back({rows, cell, amplitude});
  }
  // all octaves of a row before the next row: the row stays in the cache
  cv::Mat sum(height, width, CV_32FC1, cv::Scalar(0));
  for (int row = 0; row < height; ++row) {
    for (const Octave& octave : octaves) add_octave_row(octave, row, sum);
  }
  return sum;
}

}  // namespace stillkite
