#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calibration/lens_fit.hpp"

namespace stillkite {

/// Indices of the views to calibrate with, in their order: each adds the most information on the
/// lens (largest determinant of the information matrix, "D-optimal"), which favours places in the
/// image and tilts of the board that others lack. The selection ends when another view would reduce
/// the standard deviations by less than 1 % in the geometric mean. Views whose residuals exceed
/// three times the median of all views are not selected.
[[nodiscard]] std::vector<std::size_t> select_views(std::span<const BoardView> views,
                                                    const LensModel& model, const Camera& camera);

}  // namespace stillkite
