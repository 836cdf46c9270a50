#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillkite {

/// A grey image that lies on the ground, its centre at the world's origin, columns towards +x,
/// rows towards -y (seen from above it is not mirrored). Beyond its borders it goes on as its own
/// mirror image, so no flight leaves it. Between texels it is bilinear: that is the world's truth.
///
/// Stored for the renderer as a mip pyramid of pairs: two bytes a texel, (u, v) and (u, v+1), so
/// that a bilinear sample is one load of four bytes, and a frame's texels few cache lines.
class GroundTexture {
 public:
  struct Level {
    std::int64_t offset = 0;  ///< of the level's first pair
    int width = 0;
    int height = 0;
    int pitch = 0;  ///< pairs from a row to the next: an odd number of cache lines, so that a walk
                    ///< down a column does not fall on few cache sets
  };

  /// `grey`: CV_8UC1, at least 2x2, less than 2^30 texels with its pyramid. Throws InputError.
  GroundTexture(const cv::Mat& grey, double metres_per_texel);

  [[nodiscard]] double metres_per_texel() const { return metres_per_texel_; }
  [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
  [[nodiscard]] const std::uint8_t* pairs() const { return pairs_.data(); }

  /// Texel coordinates (u, v), not folded back, of a ground point.
  [[nodiscard]] Eigen::Vector2d texel_of(const Eigen::Vector2d& ground_in_world_m) const;

  /// Grey value of the ground at a point, from the finest level.
  [[nodiscard]] double grey_at(const Eigen::Vector2d& ground_in_world_m) const;

 private:
  double metres_per_texel_;
  std::vector<Level> levels_;
  std::vector<std::uint8_t> pairs_;
};

}  // namespace stillkite
