#pragma once

#include <cstdint>
#include <vector>

#include "geometry/fields.hpp"

namespace stillkite {

struct ReliefConfig {
  double amplitude_m = 0;
  double correlation_length_m = 60;

  static void fields(auto& self, auto&& field) {
    field("amplitude_m", self.amplitude_m, Range{0, 1000},
          "maximum of |z| of the relief; 0: flat ground");
    field("correlation_length_m", self.correlation_length_m, kPositive,
          "correlation length of the ground height");
  }
};

/// Height map z(x, y): Gaussian random knots on a lattice with a spacing of one correlation length,
/// interpolated by uniform cubic B-splines. Scaled to max |z| = amplitude; period 64 correlation
/// lengths. Sampled on a grid of 16 cells per correlation length with bilinear interpolation; this
/// defines the ground truth.
class Relief {
 public:
  static constexpr int kCellsPerSide = 1024;

  Relief(const ReliefConfig& config, std::uint64_t seed);

  [[nodiscard]] double height_m(double x_m, double y_m) const;
  [[nodiscard]] double amplitude_m() const { return amplitude_m_; }
  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] double metres_per_count() const { return metres_per_count_; }
  /// Word of (x, y): 16-bit heights of (x, y) in the lower and of (x + 1, y) in the upper half.
  [[nodiscard]] const std::uint32_t* words() const { return words_.data(); }

 private:
  double amplitude_m_;
  double cell_m_;
  double metres_per_count_;
  std::vector<std::uint32_t> words_;
};

}  // namespace stillkite
