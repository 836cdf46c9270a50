#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillkite {

/// Windows side by side over one image. Padded with empty tiles to a multiple of
/// `kPadding`, so that vector code needs no remainder loop.
struct TileGrid {
  static constexpr int kPadding = 16;
  /// Left of and above a tile, right of and below it: what interpolation needs.
  static constexpr int kBefore_px = 2;
  static constexpr int kAfter_px = 3;
  static constexpr int kMostRows = 24;

  int columns = 0;  ///< width of a tile, px: 16 or 32
  int rows = 0;     ///< height of a tile, px: at most `kMostRows`
  int count = 0;    ///< tiles, padding included
  std::vector<int> left_px, top_px;
  std::vector<float> centre_x_px, centre_y_px;
};

/// Keeps the margin that a tile needs.
[[nodiscard]] TileGrid make_tile_grid(int width_px, int height_px, int columns_per_tile,
                                      int rows_per_tile);

/// Where each tile of the reference is expected in the current image: its centre and the
/// deformation d(current)/d(reference) about it. A tile off the image is skipped.
struct TilePlacement {
  std::vector<float> x_px, y_px;
  std::vector<float> axx, axy, ayx, ayy;

  void resize(int count);
  static constexpr float kNowhere_px = -1e6F;
};

/// What Lucas-Kanade learns of a tile's displacement u from its expected place, information form:
/// G u = g with the structure tensor G, both over the tile and after removal of the tile's mean
/// (a change of brightness costs nothing). Axes of the current image. A skipped tile is all zero.
struct TileMeasurements {
  std::vector<float> gxx, gxy, gyy;  ///< grey^2/px^2
  std::vector<float> gx, gy;         ///< grey^2/px
  std::vector<float> residual;       ///< sum of squared residuals before the step, grey^2
  std::vector<float> contrast;       ///< sum of (I - mean)^2 of the reference, grey^2
  std::vector<float> gain_product;   ///< sum of (I - mean) * residual, grey^2

  void resize(int count);
};

/// A sum over a tile, and the sums with the distance from its middle, px.
struct TileMoments {
  float sum = 0, by_x = 0, by_y = 0;
};

/// What of a tile's sums is its reference's alone: those of the products of its gradient, which
/// are G, and of the gradient itself.
struct TileTexture {
  TileMoments xx, xy, yy, x, y;
};

/// The tiles' textures, each learnt when it is first measured, and good for as long as the grid
/// lies on the same image.
struct TileTextures {
  std::vector<TileTexture> tiles;
  std::vector<unsigned char> known;

  /// For another image or another grid.
  void forget(const TileGrid& grid);
};

enum class TileWarp {
  shift,   ///< a tile is shifted in 16-bit integers, its deformation is taken to first order
  affine,  ///< every pixel is warped as the placement says, however large the deformation
};

/// What a shifted tile may do without: quintic interpolation (else bilinear, whose error does not
/// matter on the way to a finer level), and the sums `contrast` and `gain_product`, which are then
/// 0. A deformed tile always has both.
struct TileEffort {
  bool quintic = true;
  bool contrast = true;
};

/// One Lucas-Kanade step of every tile: residual r = gain * reference - current(warped),
/// G = sum of grad grad^T, g = sum of grad r. Both images CV_8UC1 and of one size; `textures` are
/// those of `grid` on `reference`.
class TileFlow {
 public:
  const TileMeasurements& measure(const cv::Mat& reference, const cv::Mat& current,
                                  const TileGrid& grid, const TilePlacement& placement,
                                  TileWarp warp, float gain, const TileEffort& effort,
                                  TileTextures& textures);
  /// Of the last call.
  [[nodiscard]] const TileMeasurements& measurements() const { return measurements_; }

 private:
  TileMeasurements measurements_;
};

}  // namespace stillkite
