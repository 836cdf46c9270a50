#include "simulation/render/patch_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

constexpr int kTileColumns = BearingSegment::kColumns;
constexpr int kTileRows = PatchTile::kRows;
constexpr int kTilesAGroup = 5;

float at(const std::array<float, 4>& cubic, float t) {
  return cubic[0] + t * (cubic[1] + t * (cubic[2] + t * cubic[3]));
}

BearingBounds bounds_between(const Eigen::Array2f& low, const Eigen::Array2f& high,
                             bool all_valid) {
  constexpr float kRounding = 1e-6F;
  return {.centre_x = 0.5F * (low.x() + high.x()),
          .centre_y = 0.5F * (low.y() + high.y()),
          .reach_x = 0.5F * (high.x() - low.x()) + kRounding,
          .reach_y = 0.5F * (high.y() - low.y()) + kRounding,
          .all_valid = all_valid};
}

BearingBounds bounds_of(const BearingTable& bearings, int first_row, int rows, int first_segment,
                        int segments) {
  Eigen::Array2f low = Eigen::Array2f::Constant(std::numeric_limits<float>::max());
  Eigen::Array2f high = -low;
  bool all_valid = true;
  const int samples = bearings.samples_a_pixel();
  for (int k = 0; k < rows * samples * segments; ++k) {
    const BearingSegment& piece =
        bearings.row(first_row, k / segments)[first_segment + k % segments];
    if (std::isnan(piece.x[0])) {
      all_valid = false;
      continue;
    }
    const int sample = k / segments % samples;
    const double right = sample_offset(sample, bearings.supersampling).right;
    for (int column = 0; column < kTileColumns; ++column) {
      const auto t = static_cast<float>(column + right - 0.5 * (kTileColumns - 1));
      const Eigen::Array2f bearing(at(piece.x, t), at(piece.y, t));
      low = low.min(bearing);
      high = high.max(bearing);
    }
  }
  return bounds_between(low, high, all_valid);
}

// Level rounding of a sample: uniform in (0, 1) over the samples of a pixel, in permuted order.
// Point-symmetric samples share a value, so that the samples of each level are centred on the
// pixel.
float level_rounding(int sample, int samples) {
  constexpr int kStride = 3;
  const int pairs = (samples + 1) / 2;
  const int pair = std::min(sample, samples - 1 - sample);
  return (static_cast<float>(kStride * pair % pairs) + 0.5F) / static_cast<float>(pairs);
}

struct TilePosition {
  int first_row = 0;
  int rows = 0;
  int segment = 0;
};

// Sum of a tile's samples, distributed over the instants. `nearby`: candidates per instant.
using TileSum = std::array<float, kTileColumns * kTileRows>;
TileSum render_tile(const BearingTable& bearings, const std::vector<VisiblePatches>& nearby,
                    const BearingBounds& bounds, const TilePosition& tile, float background_grey) {
  TileSum sum{};
  const int samples = bearings.samples_a_pixel();
  const int instants = static_cast<int>(nearby.size());
  std::array<const BearingSegment*, kTileRows> segments{};
  for (int instant = 0; instant < instants; ++instant) {
    const VisiblePatches visible = visible_within(nearby[instant].patches, bounds);
    for (int sample = instant; sample < samples; sample += instants) {
      for (int row = 0; row < tile.rows; ++row) {
        segments[row] = bearings.row(tile.first_row + row, sample) + tile.segment;
      }
      const double right = sample_offset(sample, bearings.supersampling).right;
      add_tile({.candidates = visible.patches.data(),
                .candidate_count = static_cast<int>(visible.patches.size()),
                .covered = visible.covered,
                .background_grey = background_grey,
                .rows = tile.rows,
                .segments = segments.data(),
                .offset = static_cast<float>(right),
                .round_up = level_rounding(sample, samples),
                .grey = sum.data()});
    }
  }
  return sum;
}

std::vector<VisiblePatches> visible_at_all_instants(const std::vector<VisiblePatches>& outer,
                                                    const BearingBounds& bounds) {
  std::vector<VisiblePatches> visible;
  visible.reserve(outer.size());
  for (const VisiblePatches& at : outer) visible.push_back(visible_within(at.patches, bounds));
  return visible;
}

}  // namespace

PatchRenderer::PatchRenderer(const Camera& camera, int supersampling, const LensError& lens_error)
    : camera_(camera), bearings_(tabulate_bearings(camera, lens_error, supersampling)) {
  const int segments = bearings_.segments_a_row;
  for (int row = 0; row < camera.height_px; row += kTileRows) {
    const int rows = std::min(kTileRows, camera.height_px - row);
    bands_.push_back(bounds_of(bearings_, row, rows, 0, segments));
    for (int first = 0; first < segments; first += kTilesAGroup) {
      const int count = std::min(kTilesAGroup, segments - first);
      groups_.push_back(bounds_of(bearings_, row, rows, first, count));
    }
    for (int segment = 0; segment < segments; ++segment) {
      tiles_.push_back(bounds_of(bearings_, row, rows, segment, 1));
    }
  }
}

cv::Mat PatchRenderer::render(const PatchScene& scene,
                              const RigidTransform& world_from_camera) const {
  return render(scene, Shutter{world_from_camera, world_from_camera, 1});
}

cv::Mat PatchRenderer::render(const PatchScene& scene, const Shutter& shutter) const {
  cv::Mat image(camera_.height_px, camera_.width_px, CV_32FC1);
  render_rows(scene, shutter, {0, camera_.height_px}, image);
  return image;
}

void PatchRenderer::render_rows(const PatchScene& scene, const Shutter& shutter,
                                const cv::Range& rows, cv::Mat& image) const {
  const int samples = bearings_.samples_a_pixel();
  if (shutter.instants < 1 || samples % shutter.instants != 0) {
    throw InputError("shutter: " + std::to_string(shutter.instants) +
                     " instants do not divide the " + std::to_string(samples) +
                     " samples per pixel; choose a divisor");
  }
  const int instants = shutter.instants;
  const double focal_px = std::min(camera_.focal_x_px, camera_.focal_y_px);
  std::vector<std::vector<PatchView>> views;
  std::vector<VisiblePatches> in_image;
  views.reserve(instants);
  in_image.reserve(instants);
  for (int k = 0; k < instants; ++k) {
    views.push_back(
        make_patch_views(scene,
                         interpolate(shutter.world_from_camera_at_opening,
                                     shutter.world_from_camera_at_closing, (k + 0.5) / instants),
                         focal_px));
    in_image.push_back({.patches = candidates_of(views.back())});
  }

  const float weight = 1.0F / static_cast<float>(samples);
  const auto background = static_cast<float>(scene.background_grey);
  const int segments = bearings_.segments_a_row;
  const int groups = (segments + kTilesAGroup - 1) / kTilesAGroup;
  for (int band = rows.start / kTileRows; band * kTileRows < rows.end; ++band) {
    const int first_row = std::max(rows.start, band * kTileRows);
    const int row_count = std::min(rows.end, (band + 1) * kTileRows) - first_row;
    const std::vector<VisiblePatches> in_band = visible_at_all_instants(in_image, bands_[band]);
    std::vector<VisiblePatches> in_group;
    for (int segment = 0; segment < segments; ++segment) {
      if (segment % kTilesAGroup == 0) {
        in_group =
            visible_at_all_instants(in_band, groups_[band * groups + segment / kTilesAGroup]);
      }
      const TileSum sum = render_tile(bearings_, in_group, tiles_[band * segments + segment],
                                      {first_row, row_count, segment}, background);
      const int first_column = segment * kTileColumns;
      const int columns = std::min(kTileColumns, camera_.width_px - first_column);
      for (int row = 0; row < row_count; ++row) {
        std::transform(&sum[row * kTileColumns], &sum[row * kTileColumns] + columns,
                       image.ptr<float>(first_row + row) + first_column,
                       [weight](float grey) { return weight * grey; });
      }
    }
  }
}

}  // namespace stillkite
