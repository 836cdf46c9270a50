#pragma once

#include "flow/tile_grid.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// Robust least squares of one Gauss-Newton step.
struct PlaneSolverConfig {
  bool robust = true;
  double outlier_sigma = 3.0;
  int reweightings = 2;

  static void fields(auto& self, auto&& field) {
    field("robust", self.robust, "robust loss on the tile residuals");
    field("outlier_sigma", self.outlier_sigma, Range{1e-9, 1e9},
          "normalized residual at which a tile's weight is 1/4, in standard deviations");
    field("reweightings", self.reweightings, Range{0, 20},
          "reweighted solutions per Lucas-Kanade step, after the unweighted one");
  }
};

/// Pyramid, tile size and solver of the alignment.
struct PlaneAlignmentConfig {
  int levels = 4;
  int tile_columns = 16;
  int tile_rows = 8;
  bool exact_warp = true;
  PlaneSolverConfig solver;

  static void fields(auto& self, auto&& field) {
    field("levels", self.levels, Range{1, 8}, "pyramid levels, including the full resolution");
    field("tile_columns", self.tile_columns, Range{16, 32}, "tile width: 16 or 32 px");
    field("tile_rows", self.tile_rows, Range{8, TileGrid::kMaxRows}, "tile height, px");
    field("exact_warp", self.exact_warp,
          "exact warp of every pixel in strongly deformed tiles, instead of first order");
    field("solver", self.solver, "least squares over the tiles");
  }
};

}  // namespace stillkite
