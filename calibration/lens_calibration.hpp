#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calibration/lens_fit.hpp"
#include "calibration/model_selection.hpp"

namespace stillkite {

/// Lens by views of a board, with all that its report shows.
struct LensCalibration {
  LensFit fit;
  std::vector<std::size_t> selected;  ///< indices of the views of the fit
  std::vector<HeldOutError> models;
  double lens_sigma_px = 0;
};

/// Selects views, then the lens model by held-out views, then fits it to all selected views. Throws
/// InputError, with the remedy, if the views do not determine the lens. `views`: of one image
/// size, without nearly equal ones (ViewCollector).
[[nodiscard]] LensCalibration calibrate_lens(std::span<const BoardView> views, int width_px,
                                             int height_px);

}  // namespace stillkite
