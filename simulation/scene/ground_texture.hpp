#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillkite {

/// Grey image on the ground plane: centre at the world origin, columns towards +x, rows towards -y
/// (not mirrored in a view from above). Boundary: mirrored repetition. Interpolation: bilinear;
/// this defines the ground truth.
///
/// Memory layout: a mip pyramid of byte pairs (u, v), (u, v+1) per texel. A bilinear sample is one
/// load of four bytes, and the texels of a frame share cache lines.
class GroundTexture {
 public:
  struct Level {
    std::int64_t offset = 0;  ///< index of the level's first pair
    int width = 0;
    int height = 0;
    int pitch = 0;  ///< pairs per row: an odd number of cache lines, so that the texels of a column
                    ///< spread over the cache sets
  };

  /// `grey`: CV_8UC1, at least 2x2, at most 7.5e8 texels. Throws InputError for another image or a
  /// texel size that is not positive.
  GroundTexture(const cv::Mat& grey, double metres_per_texel);

  [[nodiscard]] double metres_per_texel() const { return metres_per_texel_; }
  [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
  [[nodiscard]] const std::uint8_t* pairs() const { return pairs_.data(); }

  /// Texel coordinates (u, v) of a ground point, before the mirrored repetition.
  [[nodiscard]] Eigen::Vector2d texel_of(const Eigen::Vector2d& ground_in_world_m) const;

  /// Grey value at a ground point, from the finest level.
  [[nodiscard]] double grey_at(const Eigen::Vector2d& ground_in_world_m) const;

 private:
  double metres_per_texel_;
  std::vector<Level> levels_;
  std::vector<std::uint8_t> pairs_;
};

}  // namespace stillkite
