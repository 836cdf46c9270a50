#pragma once

#include <optional>
#include <vector>

#include "estimation/plane/plane_solver.hpp"

namespace stillkite {

/// Spatially smooth part of the residual flow of an alignment: relief, lens, coding.
struct SmoothResidual {
  double variance_px2 = 0;  ///< per component, on the level of the tiles; noise: negative
  double sigma_px2 = 0;     ///< standard deviation of `variance_px2` by independent noise
};

/// Mean product of the mean residuals of neighbouring cells (clusters of tiles, row by row):
/// noise that is independent from cell to cell does not contribute. `weights`: per tile, 0 to 1.
/// Empty with less than 12 pairs of cells.
[[nodiscard]] std::optional<SmoothResidual> measure_smooth_residual(
    const PlaneObservations& tiles, const PlaneSolution& solution,
    const std::vector<float>& weights);

}  // namespace stillkite
