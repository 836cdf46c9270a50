#pragma once

#include <vector>

#include "estimation/ego_motion/plane_motion.hpp"
#include "flow/tile_flow.hpp"
#include "geometry/camera.hpp"

namespace stillkite {

/// Bearings (x, y, 1) of the tile centres of one pyramid level, and d(bearing)/d(pixel). `usable`:
/// 1, or 0 if the lens model is not invertible there.
struct TileRays {
  std::vector<float> x, y;
  std::vector<float> dxx, dxy, dyx, dyy;
  std::vector<float> usable;
};

/// Bearings of the tiles of `grid`.
[[nodiscard]] TileRays make_tile_rays(const Camera& camera, const TileGrid& grid);

/// d(pixel in the current image)/d(PlaneMotionStep) of every tile. Row `2 k`: x, row `2 k + 1`: y
/// of parameter k; each row has `count` values.
struct TileJacobian {
  static constexpr int kParameters = 8;
  int count = 0;
  std::vector<float> rows;

  [[nodiscard]] const float* x(int parameter) const { return rows.data() + 2 * parameter * count; }
  [[nodiscard]] const float* y(int parameter) const { return x(parameter) + count; }
};

/// Rolling shutter: exposure delay of each tile's row after the frame's stamp, and the camera's
/// twist (velocity in heights/s, angular rate in rad/s) in camera.
struct TileTimes {
  std::vector<float> row_delay_s;
  Eigen::Matrix<double, 6, 1> twist;
};

/// Exact tile placement under `motion` through the lens, with its Jacobian. Above the horizon:
/// rotation only. `times`: rolling shutter of the current frame; nullptr for a global shutter.
void place_tiles(const Camera& camera, const TileRays& rays, const PlaneMotion& motion,
                 const TiltAxes& tilt_axes, TilePlacement& placement, TileJacobian& jacobian,
                 const TileTimes* times = nullptr);

/// Normal equations over the tiles: information = sum w J^T G J, gradient = sum w J^T g.
struct NormalEquations {
  PlaneMotionMatrix information = PlaneMotionMatrix::Zero();
  PlaneMotionStep gradient = PlaneMotionStep::Zero();
};

/// Sums over all tiles.
[[nodiscard]] NormalEquations accumulate(const TileJacobian& jacobian,
                                         const TileMeasurements& measurements,
                                         const std::vector<float>& weights);

/// Squared flow residual of each tile after `step`, over the pixel noise variance (two degrees of
/// freedom): e^T (G + floor I)^-1 e, e = g - G J step. 0 for tiles without information.
void squared_residuals(const TileJacobian& jacobian, const TileMeasurements& measurements,
                       const PlaneMotionStep& step, float floor, std::vector<float>& chi2);

}  // namespace stillkite
