#include "simulation/patch_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

constexpr int kTileColumns = 32;
constexpr int kTileRows = 16;
static_assert(kTileColumns % kTilePadding == 0);

struct PixelBlock {
  int first_column = 0;
  int columns = 0;
  int first_row = 0;
  int rows = 0;
};

BearingBounds bounds_of(const SampleBearings& bearings, const PixelBlock& block) {
  constexpr float kHuge = std::numeric_limits<float>::max();
  BearingBounds bounds{kHuge, -kHuge, kHuge, -kHuge};
  for (int row = block.first_row; row < block.first_row + block.rows; ++row) {
    for (int sample = 0; sample < bearings.samples; ++sample) {
      const float* x = bearings.x_row(row, sample);
      const float* y = bearings.y_row(row, sample);
      for (int column = block.first_column; column < block.first_column + block.columns; ++column) {
        const float at_x = x[column];
        const float at_y = bearings.separable ? *y : y[column];
        if (std::isnan(at_x)) {
          bounds.sees_all = false;
          continue;
        }
        bounds.low_x = std::min(bounds.low_x, at_x);
        bounds.high_x = std::max(bounds.high_x, at_x);
        bounds.low_y = std::min(bounds.low_y, at_y);
        bounds.high_y = std::max(bounds.high_y, at_y);
      }
    }
  }
  return bounds;
}

BearingBounds united(const BearingBounds& a, const BearingBounds& b) {
  return {std::min(a.low_x, b.low_x), std::max(a.high_x, b.high_x), std::min(a.low_y, b.low_y),
          std::max(a.high_y, b.high_y), a.sees_all && b.sees_all};
}

// What a tile shows at one instant is added to `light`, rows of kTileColumns.
void add_instant(const SampleBearings& bearings, const VisiblePatches& visible,
                 const PixelBlock& block, int instant, int instants, float background_grey,
                 float* light) {
  std::array<const float*, SampleBearings::kMaxSamples> x{};
  std::array<const float*, SampleBearings::kMaxSamples> y{};
  const PatchTile tile{.candidates = visible.patches.data(),
                       .candidate_count = static_cast<int>(visible.patches.size()),
                       .covered = visible.covered,
                       .background_grey = background_grey,
                       .columns = block.columns,
                       .samples = bearings.samples / instants,
                       .even_y = bearings.separable};
  for (int row = 0; row < block.rows; ++row) {
    const int picture_row = block.first_row + row;
    for (int k = 0; k < tile.samples; ++k) {
      const int sample = k * instants + instant;
      x[k] = bearings.x_row(picture_row, sample) + block.first_column;
      y[k] = bearings.y_row(picture_row, sample) + (bearings.separable ? 0 : block.first_column);
    }
    add_tile_row(tile, {.x = x.data(), .y = y.data(), .grey = light + row * kTileColumns});
  }
}

std::vector<const PatchView*> pointers_to(const std::vector<PatchView>& views) {
  std::vector<const PatchView*> pointers;
  pointers.reserve(views.size());
  for (const PatchView& view : views) pointers.push_back(&view);
  return pointers;
}

}  // namespace

PatchRenderer::PatchRenderer(const Camera& camera, int supersampling)
    : camera_(camera), bearings_(tabulate_bearings(camera, supersampling, kTilePadding)) {
  for (int row = 0; row < camera.height_px; row += kTileRows) {
    std::optional<BearingBounds> band;
    for (int column = 0; column < bearings_.padded_width; column += kTileColumns) {
      const BearingBounds tile =
          bounds_of(bearings_, {column, std::min(kTileColumns, bearings_.padded_width - column),
                                row, std::min(kTileRows, camera.height_px - row)});
      tiles_.push_back(tile);
      band = band ? united(*band, tile) : tile;
    }
    bands_.push_back(*band);
  }
}

cv::Mat PatchRenderer::render(const PatchScene& scene,
                              const RigidTransform& world_from_camera) const {
  return render(scene, Shutter{world_from_camera, world_from_camera, 1});
}

cv::Mat PatchRenderer::render(const PatchScene& scene, const Shutter& shutter) const {
  if (shutter.instants < 1 || bearings_.samples % shutter.instants != 0) {
    throw InputError("shutter: " + std::to_string(shutter.instants) +
                     " instants do not divide the " + std::to_string(bearings_.samples) +
                     " samples a pixel");
  }
  const int instants = shutter.instants;
  const double sample_focal_px =
      bearings_.supersampling * std::min(camera_.focal_x_px, camera_.focal_y_px);
  std::vector<std::vector<PatchView>> views;
  for (int k = 0; k < instants; ++k) {
    views.push_back(
        make_patch_views(scene,
                         interpolate(shutter.world_from_camera_at_opening,
                                     shutter.world_from_camera_at_closing, (k + 0.5) / instants),
                         sample_focal_px));
  }

  cv::Mat picture(camera_.height_px, camera_.width_px, CV_32FC1);
  const float share = 1.0F / static_cast<float>(bearings_.samples);
  const auto background = static_cast<float>(scene.background_grey);
  std::vector<VisiblePatches> in_band(instants);
  std::size_t tile = 0;
  for (std::size_t band = 0; band < bands_.size(); ++band) {
    const int first_row = static_cast<int>(band) * kTileRows;
    const int rows = std::min(kTileRows, camera_.height_px - first_row);
    for (int k = 0; k < instants; ++k) {
      in_band[k] = visible_within(pointers_to(views[k]), bands_[band]);
    }
    for (int column = 0; column < bearings_.padded_width; column += kTileColumns, ++tile) {
      const PixelBlock block{column, std::min(kTileColumns, bearings_.padded_width - column),
                             first_row, rows};
      std::array<float, kTileColumns * kTileRows> light{};
      for (int k = 0; k < instants; ++k) {
        add_instant(bearings_, visible_within(in_band[k].patches, tiles_[tile]), block, k, instants,
                    background, light.data());
      }
      const int columns = std::min(block.columns, camera_.width_px - column);
      for (int row = 0; row < rows; ++row) {
        std::transform(&light[row * kTileColumns], &light[row * kTileColumns] + columns,
                       picture.ptr<float>(first_row + row) + column,
                       [share](float sum) { return share * sum; });
      }
    }
  }
  return picture;
}

}  // namespace stillkite
