#include "flow/feature_patch.hpp"

namespace stillkite {

TileGrid patch_grid(const std::vector<Eigen::Vector2f>& centres_px, float scale,
                    const cv::Mat& image) {
  TileGrid grid;
  grid.columns = grid.rows = kPatch_px;
  const int count = static_cast<int>(centres_px.size());
  grid.count = (count + TileGrid::kPadding - 1) / TileGrid::kPadding * TileGrid::kPadding;
  constexpr float kHalf = 0.5F * (kPatch_px - 1);
  const auto first = [](float centre, int size) {
    return std::clamp(static_cast<int>(std::lround(centre - kHalf)), TileGrid::kBefore_px,
                      size - kPatch_px - TileGrid::kAfter_px);
  };
  for (int i = 0; i < grid.count; ++i) {
    const bool is_feature = i < count;
    const Eigen::Vector2f at =
        is_feature
            ? (((centres_px[static_cast<std::size_t>(i)].array() + 0.5F) * scale) - 0.5F).eval()
            : Eigen::Array2f::Constant(kHalf + TileGrid::kBefore_px).eval();
    grid.left_px.push_back(first(at.x(), image.cols));
    grid.top_px.push_back(first(at.y(), image.rows));
    const float offset_px = is_feature ? 0 : TilePlacement::kOutside_px;
    grid.centre_x_px.push_back(offset_px + static_cast<float>(grid.left_px.back()) + kHalf);
    grid.centre_y_px.push_back(offset_px + static_cast<float>(grid.top_px.back()) + kHalf);
  }
  return grid;
}

}  // namespace stillkite
