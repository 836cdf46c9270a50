#include "flow/tile_flow.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

namespace stillkite {
namespace {

constexpr int kSide_px = 64;

cv::Mat image(double phase) {
  cv::Mat image(kSide_px, kSide_px, CV_8UC1);
  for (int y = 0; y < kSide_px; ++y) {
    for (int x = 0; x < kSide_px; ++x) {
      const double wave = std::sin(0.4 * x + 0.1 * y + phase) + std::cos(0.3 * y - 0.2 * x);
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(128 + 50 * wave);
    }
  }
  return image;
}

// Placement of all tiles with a common shift and shear: x changes by `shear` per row.
TilePlacement placement_of(const TileGrid& grid, float dx, float dy, float shear) {
  TilePlacement placement;
  placement.resize(grid.count);
  for (std::size_t i = 0; i < placement.x_px.size(); ++i) {
    placement.x_px[i] = grid.centre_x_px[i] + dx;
    placement.y_px[i] = grid.centre_y_px[i] + dy;
    placement.axx[i] = placement.ayy[i] = 1;
    placement.axy[i] = shear;
    placement.ayx[i] = 0;
  }
  return placement;
}

TileTextures empty_textures(const TileGrid& grid) {
  TileTextures textures;
  textures.reset(grid);
  return textures;
}

class CachedTexture : public testing::TestWithParam<TileWarp> {};

TEST_P(CachedTexture, MatchesRecomputedTexture) {
  const cv::Mat reference = image(0), current = image(0.1);
  for (const int columns : {16, 32}) {
    const TileGrid grid = make_tile_grid(kSide_px, kSide_px, columns, 16);
    TileTextures cached = empty_textures(grid);
    TileFlow flow;
    // tiles outside the image at first are computed once they are inside
    for (const float dx : {40.0F, 0.3F, -0.4F}) {
      const TilePlacement placement = placement_of(grid, dx, 0.2F, 0.01F);
      const TileMeasurements with_cache =
          flow.measure(reference, current, grid, placement, GetParam(), 1, {}, cached);
      TileTextures empty = empty_textures(grid);
      const TileMeasurements& recomputed =
          flow.measure(reference, current, grid, placement, GetParam(), 1, {}, empty);
      EXPECT_EQ(with_cache.gxx, recomputed.gxx);
      EXPECT_EQ(with_cache.gxy, recomputed.gxy);
      EXPECT_EQ(with_cache.gyy, recomputed.gyy);
      EXPECT_EQ(with_cache.gx, recomputed.gx);
      EXPECT_EQ(with_cache.gy, recomputed.gy);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Warps, CachedTexture, testing::Values(TileWarp::shift, TileWarp::affine));

// Wave: G is the sum of squares of its central differences.
TEST(TileFlow, StructureTensorAndStepMatchAnalyticWave) {
  constexpr double kPeriod_px = 16, kAmplitude = 100, kShift_px = 0.1;
  const double k = 2 * std::numbers::pi / kPeriod_px;
  const auto wave = [&](double shift) {
    cv::Mat image(kSide_px, kSide_px, CV_8UC1);
    for (int y = 0; y < kSide_px; ++y) {
      for (int x = 0; x < kSide_px; ++x) {
        image.at<std::uint8_t>(y, x) =
            cv::saturate_cast<std::uint8_t>(128 + kAmplitude * std::sin(k * (x - shift)));
      }
    }
    return image;
  };
  const TileGrid grid = make_tile_grid(kSide_px, kSide_px, 16, 16);
  TileTextures textures = empty_textures(grid);
  TileFlow flow;
  const TileMeasurements& m =
      flow.measure(wave(0), wave(kShift_px), grid, placement_of(grid, 0, 0, 0), TileWarp::shift, 1,
                   {}, textures);
  const double G = 16 * 16 * 0.5 * std::pow(kAmplitude * std::sin(k), 2);
  EXPECT_NEAR(m.gxx[0], G, 0.01 * G);
  EXPECT_NEAR(m.gxy[0], 0, 1e-3 * G);
  EXPECT_NEAR(m.gyy[0], 0, 1e-3 * G);
  EXPECT_NEAR(m.gx[0] / m.gxx[0], kShift_px, 0.03 * kShift_px);
}

class FineTexture : public testing::TestWithParam<TileWarp> {};

// Interpolation errors at wavelengths of 5 px cause a bias common to all tiles.
TEST_P(FineTexture, MeasuresSubPixelShifts) {
  const auto shifted_image = [](const cv::Point2d& shift_px) {
    cv::Mat image(kSide_px, kSide_px, CV_8UC1);
    for (int y = 0; y < kSide_px; ++y) {
      for (int x = 0; x < kSide_px; ++x) {
        const double waves = std::sin(2 * std::numbers::pi / 5.0 * (x - shift_px.x)) +
                             std::sin(2 * std::numbers::pi / 5.3 * (y - shift_px.y));
        image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(128 + 60 * waves);
      }
    }
    return image;
  };
  const TileGrid grid = make_tile_grid(kSide_px, kSide_px, 16, 16);
  TileTextures textures = empty_textures(grid);
  TileFlow flow;
  for (const cv::Point2d& shift_px : {cv::Point2d(0.25, 0.15), {0.4, 0.7}, {-0.2, 0.85}}) {
    constexpr int kSteps = 8;
    cv::Point2d estimated_px(0, 0);
    for (int step = 0; step < kSteps; ++step) {
      const TilePlacement placement = placement_of(grid, static_cast<float>(estimated_px.x),
                                                   static_cast<float>(estimated_px.y), 0);
      const TileMeasurements& m = flow.measure(shifted_image({0, 0}), shifted_image(shift_px), grid,
                                               placement, GetParam(), 1, {}, textures);
      estimated_px += cv::Point2d(m.gx[4] / m.gxx[4], m.gy[4] / m.gyy[4]);
    }
    EXPECT_NEAR(estimated_px.x, shift_px.x, 0.006);
    EXPECT_NEAR(estimated_px.y, shift_px.y, 0.006);
  }
}

INSTANTIATE_TEST_SUITE_P(Warps, FineTexture, testing::Values(TileWarp::shift, TileWarp::affine));

struct Warp {
  const char* name;
  double xx, xy, yx, yy;
};

class DeformedTile : public testing::TestWithParam<Warp> {};

// Current image: the reference deformed by the placement. The residual is the quantization of both
// images, also for tiles near the border.
TEST_P(DeformedTile, LeavesQuantizationResidualOnly) {
  constexpr double kCentre_px = 0.5 * (kSide_px - 1);
  const Warp& a = GetParam();
  const auto grey = [](double x, double y) {
    return cv::saturate_cast<std::uint8_t>(
        128 + 55 * (std::sin(0.9 * x + 0.2 * y) + std::cos(0.8 * y - 0.3 * x)));
  };
  cv::Mat reference(kSide_px, kSide_px, CV_8UC1), current = reference.clone();
  const double determinant = a.xx * a.yy - a.xy * a.yx;
  for (int y = 0; y < kSide_px; ++y) {
    for (int x = 0; x < kSide_px; ++x) {
      const double dx = x - kCentre_px - 0.3, dy = y - kCentre_px + 0.4;
      reference.at<std::uint8_t>(y, x) = grey(x, y);
      current.at<std::uint8_t>(y, x) = grey(kCentre_px + (a.yy * dx - a.xy * dy) / determinant,
                                            kCentre_px + (a.xx * dy - a.yx * dx) / determinant);
    }
  }
  for (const int columns : {16, 32}) {
    for (const int rows : {8, 16, 24}) {
      const TileGrid grid = make_tile_grid(kSide_px, kSide_px, columns, rows);
      TilePlacement placement = placement_of(grid, 0, 0, 0);
      for (std::size_t i = 0; i < placement.x_px.size(); ++i) {
        const double dx = grid.centre_x_px[i] - kCentre_px, dy = grid.centre_y_px[i] - kCentre_px;
        placement.x_px[i] = static_cast<float>(kCentre_px + 0.3 + a.xx * dx + a.xy * dy);
        placement.y_px[i] = static_cast<float>(kCentre_px - 0.4 + a.yx * dx + a.yy * dy);
        placement.axx[i] = static_cast<float>(a.xx);
        placement.axy[i] = static_cast<float>(a.xy);
        placement.ayx[i] = static_cast<float>(a.yx);
        placement.ayy[i] = static_cast<float>(a.yy);
      }
      TileTextures textures = empty_textures(grid);
      TileFlow flow;
      const TileMeasurements& m =
          flow.measure(reference, current, grid, placement, TileWarp::affine, 1, {}, textures);
      int measured = 0;
      for (std::size_t i = 0; i < m.gxx.size(); ++i) {
        if (m.gxx[i] == 0) continue;
        ++measured;
        constexpr double kRoundings_grey2 = 2.0 / 12;
        EXPECT_LT(m.residual[i] / static_cast<float>(columns * rows), 1.5 * kRoundings_grey2) << i;
        EXPECT_NEAR(m.gx[i] / m.gxx[i], 0, 0.004) << i;
        EXPECT_NEAR(m.gy[i] / m.gyy[i], 0, 0.004) << i;
      }
      EXPECT_GE(measured, 2) << columns << 'x' << rows;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Warps, DeformedTile,
                         testing::Values(Warp{"identity", 1, 0, 0, 1},
                                         Warp{"rotated_by_3_deg", 0.9986, -0.0523, 0.0523, 0.9986},
                                         Warp{"rotated_by_minus_3_deg", 0.9986, 0.0523, -0.0523,
                                              0.9986},
                                         Warp{"enlarged_and_sheared", 1.1, 0.12, 0.06, 1.05},
                                         Warp{"reduced", 0.85, -0.15, -0.066, 0.9},
                                         Warp{"rotated_by_30_deg", 0.866, -0.5, 0.5, 0.866},
                                         Warp{"rotated_by_90_deg", 0, -1, 1, 0}),
                         [](const auto& test) { return test.param.name; });

// Maximum gradient of 255 in all rows: no overflow. A shear about the centre moves the upper and
// the lower half of the edge in opposite directions.
TEST(TileFlow, ShearedEdgeDoesNotMove) {
  cv::Mat edge(kSide_px, kSide_px, CV_8UC1, cv::Scalar(0));
  edge.colRange(kSide_px / 2 + 1, kSide_px) = 255;
  const TileGrid grid = make_tile_grid(kSide_px, kSide_px, 16, 16);
  TileTextures textures = empty_textures(grid);
  TileFlow flow;
  const TileMeasurements& m = flow.measure(edge, edge, grid, placement_of(grid, 0, 0, 0.05F),
                                           TileWarp::shift, 1, {}, textures);
  for (int i = 0; i < grid.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(m.gx[k], 0, 1e-4F * (1 + m.gxx[k])) << i;
  }
}

// Maximum residual: white at a gain of 2 against black. The sum of squares of the largest tile
// needs 32 bits.
TEST(TileFlow, SumsMaximumResidualWithoutOverflow) {
  constexpr int kColumns = 32, kRows = 24;
  constexpr float kGain = 1.98F;
  const TileGrid grid = make_tile_grid(kSide_px, kSide_px, kColumns, kRows);
  cv::Mat white(kSide_px, kSide_px, CV_8UC1, cv::Scalar(255));
  white.row(grid.top_px[0] + kRows / 2) = 0;
  const cv::Mat black(kSide_px, kSide_px, CV_8UC1, cv::Scalar(0));
  TileTextures textures = empty_textures(grid);
  TileFlow flow;
  const TileMeasurements& m =
      flow.measure(white, black, grid, placement_of(grid, 0, 0, 0), TileWarp::shift, kGain,
                   {.quintic = true, .contrast = true}, textures);
  constexpr float kRowRatio = 1.0F / kRows;
  const float squares =
      kColumns * kRows * kRowRatio * (1 - kRowRatio) * (kGain * 255) * (kGain * 255);
  EXPECT_NEAR(m.residual[0], squares, 0.01F * squares);
}

}  // namespace
}  // namespace stillkite
