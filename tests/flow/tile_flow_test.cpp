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

// Every tile shifted by the same way and sheared: x moves by `shear` a row.
TilePlacement placed(const TileGrid& grid, float dx, float dy, float shear) {
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

TileTextures unknown(const TileGrid& grid) {
  TileTextures textures;
  textures.forget(grid);
  return textures;
}

class KnownTexture : public testing::TestWithParam<TileWarp> {};

TEST_P(KnownTexture, says_what_a_fresh_one_says) {
  const cv::Mat reference = image(0), current = image(0.1);
  for (const int columns : {16, 32}) {
    const TileGrid grid = make_tile_grid(kSide_px, kSide_px, columns, 16);
    TileTextures kept = unknown(grid);
    TileFlow flow;
    // tiles that were off the image at first are learnt when they are on it
    for (const float dx : {40.0F, 0.3F, -0.4F}) {
      const TilePlacement placement = placed(grid, dx, 0.2F, 0.01F);
      const TileMeasurements again =
          flow.measure(reference, current, grid, placement, GetParam(), 1, {}, kept);
      TileTextures none = unknown(grid);
      const TileMeasurements& fresh =
          flow.measure(reference, current, grid, placement, GetParam(), 1, {}, none);
      EXPECT_EQ(again.gxx, fresh.gxx);
      EXPECT_EQ(again.gxy, fresh.gxy);
      EXPECT_EQ(again.gyy, fresh.gyy);
      EXPECT_EQ(again.gx, fresh.gx);
      EXPECT_EQ(again.gy, fresh.gy);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Warps, KnownTexture, testing::Values(TileWarp::shift, TileWarp::affine));

// A wave that is known: G is the sum of squares of its slope, as central differences have it.
TEST(TileFlow, structure_tensor_of_a_wave_and_the_step_across_it) {
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
  TileTextures textures = unknown(grid);
  TileFlow flow;
  const TileMeasurements& m = flow.measure(wave(0), wave(kShift_px), grid, placed(grid, 0, 0, 0),
                                           TileWarp::shift, 1, {}, textures);
  const double G = 16 * 16 * 0.5 * std::pow(kAmplitude * std::sin(k), 2);
  EXPECT_NEAR(m.gxx[0], G, 0.01 * G);
  EXPECT_NEAR(m.gxy[0], 0, 1e-3 * G);
  EXPECT_NEAR(m.gyy[0], 0, 1e-3 * G);
  EXPECT_NEAR(m.gx[0] / m.gxx[0], kShift_px, 0.03 * kShift_px);
}

class FineTexture : public testing::TestWithParam<TileWarp> {};

// Interpolation that moves waves of some five pixels by less than it is asked to makes all windows
// of an image err alike, towards half pixels.
TEST_P(FineTexture, moves_by_parts_of_a_pixel_as_coarse_texture_does) {
  const auto moved = [](const cv::Point2d& by_px) {
    cv::Mat image(kSide_px, kSide_px, CV_8UC1);
    for (int y = 0; y < kSide_px; ++y) {
      for (int x = 0; x < kSide_px; ++x) {
        const double waves = std::sin(2 * std::numbers::pi / 5.0 * (x - by_px.x)) +
                             std::sin(2 * std::numbers::pi / 5.3 * (y - by_px.y));
        image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(128 + 60 * waves);
      }
    }
    return image;
  };
  const TileGrid grid = make_tile_grid(kSide_px, kSide_px, 16, 16);
  TileTextures textures = unknown(grid);
  TileFlow flow;
  for (const cv::Point2d& by_px : {cv::Point2d(0.25, 0.15), {0.4, 0.7}, {-0.2, 0.85}}) {
    constexpr int kSteps = 8;
    cv::Point2d found_px(0, 0);
    for (int step = 0; step < kSteps; ++step) {
      const TilePlacement placement =
          placed(grid, static_cast<float>(found_px.x), static_cast<float>(found_px.y), 0);
      const TileMeasurements& m =
          flow.measure(moved({0, 0}), moved(by_px), grid, placement, GetParam(), 1, {}, textures);
      found_px += cv::Point2d(m.gx[4] / m.gxx[4], m.gy[4] / m.gyy[4]);
    }
    EXPECT_NEAR(found_px.x, by_px.x, 0.006);
    EXPECT_NEAR(found_px.y, by_px.y, 0.006);
  }
}

INSTANTIATE_TEST_SUITE_P(Warps, FineTexture, testing::Values(TileWarp::shift, TileWarp::affine));

struct Warp {
  const char* name;
  double xx, xy, yx, yy;
};

class DeformedTile : public testing::TestWithParam<Warp> {};

// The current image is the reference's texture deformed as the placement says: what is left is
// the rounding of both to whole grey levels. Also where the tiles come near the image's border.
TEST_P(DeformedTile, is_warped_as_the_placement_says) {
  constexpr double kMiddle_px = 0.5 * (kSide_px - 1);
  const Warp& a = GetParam();
  const auto grey = [](double x, double y) {
    return cv::saturate_cast<std::uint8_t>(
        128 + 55 * (std::sin(0.9 * x + 0.2 * y) + std::cos(0.8 * y - 0.3 * x)));
  };
  cv::Mat reference(kSide_px, kSide_px, CV_8UC1), current = reference.clone();
  const double determinant = a.xx * a.yy - a.xy * a.yx;
  for (int y = 0; y < kSide_px; ++y) {
    for (int x = 0; x < kSide_px; ++x) {
      const double dx = x - kMiddle_px - 0.3, dy = y - kMiddle_px + 0.4;
      reference.at<std::uint8_t>(y, x) = grey(x, y);
      current.at<std::uint8_t>(y, x) = grey(kMiddle_px + (a.yy * dx - a.xy * dy) / determinant,
                                            kMiddle_px + (a.xx * dy - a.yx * dx) / determinant);
    }
  }
  for (const int columns : {16, 32}) {
    for (const int rows : {8, 16, 24}) {
      const TileGrid grid = make_tile_grid(kSide_px, kSide_px, columns, rows);
      TilePlacement placement = placed(grid, 0, 0, 0);
      for (std::size_t i = 0; i < placement.x_px.size(); ++i) {
        const double dx = grid.centre_x_px[i] - kMiddle_px, dy = grid.centre_y_px[i] - kMiddle_px;
        placement.x_px[i] = static_cast<float>(kMiddle_px + 0.3 + a.xx * dx + a.xy * dy);
        placement.y_px[i] = static_cast<float>(kMiddle_px - 0.4 + a.yx * dx + a.yy * dy);
        placement.axx[i] = static_cast<float>(a.xx);
        placement.axy[i] = static_cast<float>(a.xy);
        placement.ayx[i] = static_cast<float>(a.yx);
        placement.ayy[i] = static_cast<float>(a.yy);
      }
      TileTextures textures = unknown(grid);
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
                         testing::Values(Warp{"none", 1, 0, 0, 1},
                                         Warp{"turned_by_3_deg", 0.9986, -0.0523, 0.0523, 0.9986},
                                         Warp{"turned_back", 0.9986, 0.0523, -0.0523, 0.9986},
                                         Warp{"nearer_and_sheared", 1.1, 0.12, 0.06, 1.05},
                                         Warp{"farther", 0.85, -0.15, -0.066, 0.9},
                                         Warp{"turned_by_30_deg", 0.866, -0.5, 0.5, 0.866},
                                         Warp{"upright", 0, -1, 1, 0}),
                         [](const auto& test) { return test.param.name; });

// From black to white the gradient is 255 in all sixteen rows of a column: no sum may overflow. A
// shear about the middle moves the upper half of the edge as far as the lower half, to other sides.
TEST(TileFlow, a_sheared_edge_from_black_to_white_does_not_move) {
  cv::Mat edge(kSide_px, kSide_px, CV_8UC1, cv::Scalar(0));
  edge.colRange(kSide_px / 2 + 1, kSide_px) = 255;
  const TileGrid grid = make_tile_grid(kSide_px, kSide_px, 16, 16);
  TileTextures textures = unknown(grid);
  TileFlow flow;
  const TileMeasurements& m =
      flow.measure(edge, edge, grid, placed(grid, 0, 0, 0.05F), TileWarp::shift, 1, {}, textures);
  for (int i = 0; i < grid.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(m.gx[k], 0, 1e-4F * (1 + m.gxx[k])) << i;
  }
}

// White that should be twice as bright and is black, but for one row: in the largest window the
// squares of what is left fill 32 bits.
TEST(TileFlow, white_that_became_black_leaves_its_squares) {
  constexpr int kColumns = 32, kRows = 24;
  constexpr float kGain = 1.98F;
  const TileGrid grid = make_tile_grid(kSide_px, kSide_px, kColumns, kRows);
  cv::Mat white(kSide_px, kSide_px, CV_8UC1, cv::Scalar(255));
  white.row(grid.top_px[0] + kRows / 2) = 0;
  const cv::Mat black(kSide_px, kSide_px, CV_8UC1, cv::Scalar(0));
  TileTextures textures = unknown(grid);
  TileFlow flow;
  const TileMeasurements& m =
      flow.measure(white, black, grid, placed(grid, 0, 0, 0), TileWarp::shift, kGain,
                   {.quintic = true, .contrast = true}, textures);
  constexpr float kShare = 1.0F / kRows;
  const float squares = kColumns * kRows * kShare * (1 - kShare) * (kGain * 255) * (kGain * 255);
  EXPECT_NEAR(m.residual[0], squares, 0.01F * squares);
}

}  // namespace
}  // namespace stillkite
