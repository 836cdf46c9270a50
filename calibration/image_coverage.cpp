#include "calibration/image_coverage.hpp"

namespace stillkite {

std::vector<std::string_view> unseen_corners(std::span<const BoardView> views, int width_px,
                                             int height_px) {
  std::array<bool, 4> is_seen{};
  const double margin_x = kCornerRegion_ratio * width_px;
  const double margin_y = kCornerRegion_ratio * height_px;
  for (const BoardView& view : views) {
    for (const Eigen::Vector2d& pixel : view.pixels) {
      const bool left = pixel.x()<margin_x, right = pixel.x()> width_px - 1 - margin_x;
      const bool upper = pixel.y()<margin_y, lower = pixel.y()> height_px - 1 - margin_y;
      is_seen[0] |= upper && left;
      is_seen[1] |= upper && right;
      is_seen[2] |= lower && left;
      is_seen[3] |= lower && right;
    }
  }
  std::vector<std::string_view> unseen;
  for (std::size_t i = 0; i < is_seen.size(); ++i) {
    if (!is_seen[i]) unseen.push_back(kImageCorners[i]);
  }
  return unseen;
}

}  // namespace stillkite
