#pragma once

#include <span>
#include <vector>

#include "calibration/lens_fit.hpp"

namespace stillkite {

/// Error of a lens model in views that did not take part in its fit.
struct HeldOutError {
  LensModel model;
  double rms_px = 0;                ///< of a component
  std::vector<double> squared_px2;  ///< of each view, mean of a component
};

/// Cross-validation: the lens is fitted without each fifth of the views, the poses of those with
/// the fitted lens. Empty if a fit fails, or if the model is not one-to-one over the image.
[[nodiscard]] std::vector<HeldOutError> held_out_errors(std::span<const BoardView> views,
                                                        int width_px, int height_px);

/// Simplest model that does not differ from the best by more than one standard error of the mean
/// difference over the views (Breiman et al., "Classification and regression trees", 1984).
/// Precondition: not empty.
[[nodiscard]] LensModel select_model(std::span<const HeldOutError> errors);

/// True if every pixel of the image's border has one bearing.
[[nodiscard]] bool covers_image(const Camera& camera);

}  // namespace stillkite
