#include "flow/tile_flow.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flow/tile_sums.hpp"

namespace stillkite {
namespace {

std::array<QuinticWeights, 128> make_quintic_weights() {
  std::array<QuinticWeights, 128> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double fraction = static_cast<double>(i) / 128;
    for (int k = -2; k <= 3; ++k) {
      double weight = 1;
      for (int j = -2; j <= 3; ++j) {
        if (j != k) weight *= (fraction - j) / (k - j);
      }
      table[i][static_cast<std::size_t>(k + 2)] =
          static_cast<std::int16_t>(std::min(std::lround(weight * 32768), 32767L));
    }
  }
  return table;
}

}  // namespace

const QuinticWeights& quintic_weights(int fraction_128) {
  static const std::array<QuinticWeights, 128> table = make_quintic_weights();
  return table[static_cast<std::size_t>(fraction_128)];
}

TileGrid make_tile_grid(int width_px, int height_px, int columns_per_tile, int rows_per_tile) {
  TileGrid grid;
  grid.columns = columns_per_tile;
  grid.rows = rows_per_tile;
  constexpr int kMargin_px = TileGrid::kBefore_px + TileGrid::kAfter_px;
  const int columns = std::max(0, (width_px - kMargin_px) / columns_per_tile);
  const int lines = std::max(0, (height_px - kMargin_px) / rows_per_tile);
  const int left = (width_px - columns * columns_per_tile) / 2;
  const int top = (height_px - lines * rows_per_tile) / 2;
  const int padding = TileGrid::kPadding;
  grid.count = (columns * lines + padding - 1) / padding * padding;
  for (int i = 0; i < grid.count; ++i) {
    const bool is_tile = i < columns * lines;
    const int x = is_tile ? left + i % columns * columns_per_tile : 0;
    const int y = is_tile ? top + i / columns * rows_per_tile : 0;
    grid.left_px.push_back(x);
    grid.top_px.push_back(y);
    // padding tiles lie outside every image
    const float centre = is_tile ? 0.0F : TilePlacement::kOutside_px;
    grid.centre_x_px.push_back(centre + static_cast<float>(x) +
                               0.5F * static_cast<float>(columns_per_tile - 1));
    grid.centre_y_px.push_back(centre + static_cast<float>(y) +
                               0.5F * static_cast<float>(rows_per_tile - 1));
  }
  return grid;
}

void TilePlacement::resize(int count) {
  for (auto* v : {&x_px, &y_px, &axx, &axy, &ayx, &ayy}) v->resize(static_cast<std::size_t>(count));
}

void TileMeasurements::resize(int count) {
  for (auto* v : {&gxx, &gxy, &gyy, &gx, &gy, &residual, &contrast, &gain_product}) {
    v->resize(static_cast<std::size_t>(count));
  }
}

void TileTextures::reset(const TileGrid& grid) {
  tiles.resize(static_cast<std::size_t>(grid.count));
  computed.assign(tiles.size(), 0);
}

const TileMeasurements& TileFlow::measure(const cv::Mat& reference, const cv::Mat& current,
                                          const TileGrid& grid, const TilePlacement& placement,
                                          TileWarp warp, float gain, const TileOptions& options,
                                          TileTextures& textures) {
  CV_Assert(reference.type() == CV_8UC1 && current.type() == CV_8UC1);
  CV_Assert(reference.size() == current.size());
  CV_Assert(textures.computed.size() == static_cast<std::size_t>(grid.count));
  measurements_.resize(grid.count);
  const auto image_view = [](const cv::Mat& m) {
    return ImageView{m.data, static_cast<std::ptrdiff_t>(m.step[0]), m.cols, m.rows};
  };
  if (warp == TileWarp::shift) {
    measure_shifted(image_view(reference), image_view(current), grid, placement, gain, options,
                    textures, measurements_);
  } else {
    measure_deformed(image_view(reference), image_view(current), grid, placement, gain, textures,
                     measurements_);
  }
  return measurements_;
}

}  // namespace stillkite
