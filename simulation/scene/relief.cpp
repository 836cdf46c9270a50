#include "simulation/scene/relief.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulation/random.hpp"

namespace stillkite {
namespace {

constexpr int kSide = Relief::kCellsPerSide;
constexpr int kCellsPerKnot = 16;
constexpr int kKnots = kSide / kCellsPerKnot;
constexpr double kFullScale = 32000;

// Weights of the four neighbouring knots of a uniform cubic B-spline, 0 <= t < 1.
std::array<double, 4> spline_weights(double t) {
  const double s = 1 - t;
  return {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
          t * t * t / 6};
}

// Evaluates the periodic spline of kKnots knots (stride `step`) at kSide points.
void evaluate_spline(const double* in, int step, double* out, int out_step) {
  for (int i = 0; i < kSide; ++i) {
    const auto weights = spline_weights(static_cast<double>(i % kCellsPerKnot) / kCellsPerKnot);
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      const int knot = (i / kCellsPerKnot + k + kKnots - 1) % kKnots;
      sum += weights[static_cast<std::size_t>(k)] * in[knot * step];
    }
    out[i * out_step] = sum;
  }
}

}  // namespace

Relief::Relief(const ReliefConfig& config, std::uint64_t seed)
    : amplitude_m_(config.amplitude_m),
      cell_m_(config.correlation_length_m / kCellsPerKnot),
      metres_per_count_(config.amplitude_m / kFullScale),
      words_(std::size_t{kSide} * kSide) {
  Random random(seed);
  std::vector<double> knots(std::size_t{kKnots} * kKnots);
  for (double& knot : knots) knot = random.normal();
  std::vector<double> rows(std::size_t{kKnots} * kSide);
  for (int r = 0; r < kKnots; ++r) evaluate_spline(&knots[r * kKnots], 1, &rows[r * kSide], 1);
  std::vector<double> grid(std::size_t{kSide} * kSide);
  for (int c = 0; c < kSide; ++c) evaluate_spline(&rows[c], kSide, &grid[c], kSide);

  double peak = 0;
  for (const double z : grid) peak = std::max(peak, std::abs(z));
  const auto count = [&](int row, int column) {
    const double z = grid[static_cast<std::size_t>(row) * kSide + column % kSide];
    return static_cast<std::uint16_t>(
        static_cast<std::int16_t>(std::lround(z / peak * kFullScale)));
  };
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      words_[static_cast<std::size_t>(row) * kSide + column] =
          std::uint32_t{count(row, column)} | std::uint32_t{count(row, column + 1)} << 16;
    }
  }
}

double Relief::height_m(double x_m, double y_m) const {
  const double x = x_m / cell_m_;
  const double y = y_m / cell_m_;
  const double a = x - std::floor(x);
  const double b = y - std::floor(y);
  const auto column = static_cast<std::int64_t>(std::floor(x)) & (kSide - 1);
  const auto row = static_cast<std::int64_t>(std::floor(y)) & (kSide - 1);
  const auto along = [&](std::int64_t r) {
    const std::uint32_t pair = words_[static_cast<std::size_t>(r * kSide + column)];
    return (1 - a) * static_cast<std::int16_t>(pair & 0xffff) +
           a * static_cast<std::int16_t>(pair >> 16);
  };
  return metres_per_count_ * ((1 - b) * along(row) + b * along((row + 1) & (kSide - 1)));
}

}  // namespace stillkite
