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
          "height of the highest hill over z = 0, metres; 0 is a flat ground");
    field("correlation_length_m", self.correlation_length_m, kPositive,
          "distance over which the ground's height changes, metres");
  }
};

/// A smooth height map z(x, y): random heights on a lattice of one correlation length, joined by
/// uniform cubic B-splines, scaled so that max |z| is the amplitude, repeating every 64 lengths.
/// Kept on a grid, 16 cells a length, bilinear between: that is the world's truth.
class Relief {
 public:
  static constexpr int kCellsPerSide = 1024;

  Relief(const ReliefConfig& config, std::uint64_t seed);

  [[nodiscard]] double height_m(double x_m, double y_m) const;
  [[nodiscard]] double amplitude_m() const { return amplitude_m_; }
  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] double metres_per_count() const { return metres_per_count_; }
  /// A word holds the 16-bit heights of (x, y) and, in its upper half, (x + 1, y).
  [[nodiscard]] const std::uint32_t* words() const { return words_.data(); }

 private:
  double amplitude_m_;
  double cell_m_;
  double metres_per_count_;
  std::vector<std::uint32_t> words_;
};

}  // namespace stillkite
