#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "flow/tile_grid.hpp"

namespace stillkite {

/// Predicted placement of each tile in the current image: centre and deformation
/// d(current)/d(reference). Tiles outside the image are skipped.
struct TilePlacement {
  std::vector<float> x_px, y_px;
  std::vector<float> axx, axy, ayx, ayy;

  void resize(int count);
  static constexpr float kOutside_px = -1e6F;
};

/// Lucas-Kanade measurement of each tile's displacement u from its predicted placement, in
/// information form: G u = g with the structure tensor G. Sums over the tile after removal of its
/// mean (invariant to brightness offsets), in axes of the current image. Skipped tile: all zero.
struct TileMeasurements {
  std::vector<float> gxx, gxy, gyy;  ///< grey^2/px^2
  std::vector<float> gx, gy;         ///< grey^2/px
  std::vector<float> residual;       ///< sum of squared residuals before the step, grey^2
  std::vector<float> contrast;       ///< sum of (I - mean)^2 of the reference, grey^2
  std::vector<float> gain_product;   ///< sum of (I - mean) * residual, grey^2

  void resize(int count);
};

/// Sum over a tile and its first moments about the centre, px.
struct TileMoments {
  float sum = 0, by_x = 0, by_y = 0;
};

/// Moments of a reference tile: products of the gradient (G) and the gradient itself.
struct TileTexture {
  TileMoments xx, xy, yy, x, y;
};

/// Cache of the tiles' textures, computed on first use; valid for one grid and one image.
struct TileTextures {
  std::vector<TileTexture> tiles;
  std::vector<unsigned char> computed;

  /// Call after a change of image or grid.
  void reset(const TileGrid& grid);
};

enum class TileWarp {
  shift,   ///< shift in 16-bit integers; deformation to first order
  affine,  ///< full affine warp of every pixel
};

/// Options of `TileWarp::shift`; `TileWarp::affine` always uses both. quintic: interpolation, else
/// bilinear (sufficient on coarse levels). contrast: also sums `contrast` and `gain_product`.
struct TileOptions {
  bool quintic = true;
  bool contrast = true;
};

/// Lucas-Kanade measurement of every tile: r = gain * reference - current(warped),
/// G = sum grad grad^T, g = sum grad r. Images: CV_8UC1, same size. `textures`: cache of `grid` on
/// `reference`.
class TileFlow {
 public:
  const TileMeasurements& measure(const cv::Mat& reference, const cv::Mat& current,
                                  const TileGrid& grid, const TilePlacement& placement,
                                  TileWarp warp, float gain, const TileOptions& options,
                                  TileTextures& textures);
  /// Result of the last call.
  [[nodiscard]] const TileMeasurements& measurements() const { return measurements_; }

 private:
  TileMeasurements measurements_;
};

}  // namespace stillkite
