#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "flow/tile_flow.hpp"

namespace stillkite {

struct ImageView {
  const std::uint8_t* data;
  std::ptrdiff_t stride;
  int width;
  int height;
};

/// Sums over a tile that involve the current image: gradient (central differences) times residual,
/// residual, brightness. Units: grey and px.
struct TileSums {
  float gx = 0, gy = 0;
  float r = 0, rr = 0, i0 = 0, i0i0 = 0, i0r = 0;
};

/// d(current)/d(reference) about a tile.
struct Deformation {
  float xx = 1, xy = 0, yx = 0, yy = 1;
};

/// Removes the tile's mean from gradient, residual and reference. Transforms the gradient from the
/// axes of the reference to those of the current image: grad' = A^-T grad.
inline void store(const TileTexture& t, const TileSums& s, float pixels, const Deformation& a,
                  int i, TileMeasurements& out) {
  const float n = 1.0F / pixels;
  const float gxx = t.xx.sum - t.x.sum * t.x.sum * n;
  const float gxy = t.xy.sum - t.x.sum * t.y.sum * n;
  const float gyy = t.yy.sum - t.y.sum * t.y.sum * n;
  const float gx = s.gx - t.x.sum * s.r * n;
  const float gy = s.gy - t.y.sum * s.r * n;
  const float d = 1.0F / (a.xx * a.yy - a.xy * a.yx);
  const float bxx = a.yy * d, bxy = -a.yx * d, byx = -a.xy * d, byy = a.xx * d;  // A^-T
  const float hxx = bxx * gxx + bxy * gxy, hxy = bxx * gxy + bxy * gyy;
  const float hyx = byx * gxx + byy * gxy, hyy = byx * gxy + byy * gyy;
  const auto k = static_cast<std::size_t>(i);
  out.gxx[k] = hxx * bxx + hxy * bxy;
  out.gxy[k] = hxx * byx + hxy * byy;
  out.gyy[k] = hyx * byx + hyy * byy;
  out.gx[k] = bxx * gx + bxy * gy;
  out.gy[k] = byx * gx + byy * gy;
  out.residual[k] = std::max(0.0F, s.rr - s.r * s.r * n);
  out.contrast[k] = std::max(0.0F, s.i0i0 - s.i0 * s.i0 * n);
  out.gain_product[k] = s.i0r - s.i0 * s.r * n;
}

/// Lagrange interpolation weights of six pixels, in 1/32768, for a position between the third and
/// the fourth. Error for a wave of 5 px shifted by 1/4 px: 1/600 px; Keys' cubic 1/40 px, bilinear
/// 1/20 px, correlated over all tiles of an image.
using QuinticWeights = std::array<std::int16_t, 6>;
/// `fraction_128`: position in 1/128 px, 0 to 127.
[[nodiscard]] const QuinticWeights& quintic_weights(int fraction_128);

void measure_shifted(const ImageView& reference, const ImageView& current, const TileGrid& grid,
                     const TilePlacement& placement, float gain, const TileOptions& options,
                     TileTextures& textures, TileMeasurements& out);
void measure_deformed(const ImageView& reference, const ImageView& current, const TileGrid& grid,
                      const TilePlacement& placement, float gain, TileTextures& textures,
                      TileMeasurements& out);

}  // namespace stillkite
