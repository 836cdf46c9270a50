#pragma once

#include <vector>

#include "estimation/ego_motion/plane_motion.hpp"
#include "flow/tile_flow.hpp"
#include "geometry/camera.hpp"

namespace stillkite {

/// Bearings of the tiles of one pyramid level: (x, y, 1) of a tile's centre and
/// d(bearing)/d(pixel) there. `usable` is 0 where the lens cannot be inverted, else 1.
struct TileRays {
  std::vector<float> x, y;
  std::vector<float> dxx, dxy, dyx, dyy;
  std::vector<float> usable;
};

[[nodiscard]] TileRays make_tile_rays(const Camera& camera, const TileGrid& grid);

/// d(pixel in the current image)/d(PlaneMotionStep) of every tile: row `2 k` is x, `2 k + 1` is y
/// of parameter k, each `count` long.
struct TileJacobian {
  static constexpr int kParameters = 8;
  int count = 0;
  std::vector<float> rows;

  [[nodiscard]] const float* x(int parameter) const { return rows.data() + 2 * parameter * count; }
  [[nodiscard]] const float* y(int parameter) const { return x(parameter) + count; }
};

/// Of a rolling shutter: how much later than the frame's stamp the row of each tile is exposed, and
/// the camera's velocity (heights a second) and angular rate meanwhile, in its own axes.
struct TileTimes {
  std::vector<float> later_s;
  Eigen::Matrix<double, 6, 1> twist;
};

/// Where the motion takes every tile through the lens, exactly, and how that depends on the
/// motion. Above the horizon only rotation is seen.
void place_tiles(const Camera& camera, const TileRays& rays, const PlaneMotion& motion,
                 const TiltAxes& tilt_axes, TilePlacement& placement, TileJacobian& jacobian,
                 const TileTimes* times = nullptr);

/// Sum of w J^T G J and of w J^T g over the tiles.
struct NormalEquations {
  PlaneMotionMatrix information = PlaneMotionMatrix::Zero();
  PlaneMotionStep gradient = PlaneMotionStep::Zero();
};
[[nodiscard]] NormalEquations accumulate(const TileJacobian& jacobian,
                                         const TileMeasurements& measurements,
                                         const std::vector<float>& weights);

/// Per tile e^T (G + floor I)^-1 e with e = g - G J step: the squared residual of its flow after
/// the step, in units of the pixel noise' variance; two degrees of freedom. 0 where nothing is
/// known.
void squared_residuals(const TileJacobian& jacobian, const TileMeasurements& measurements,
                       const PlaneMotionStep& step, float floor, std::vector<float>& chi2);

}  // namespace stillkite
