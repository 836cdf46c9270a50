#pragma once

#include <cmath>

namespace stillkite {

/// Standard deviation of the change of a lens calibration's error over a displacement in the image.
/// The error is a smooth field, the same in every image, with the standard deviation `sigma` and a
/// correlation length of a quarter of the image width (one to two periods across the image):
///   sqrt(2 sigma^2 (1 - exp(-d^2 / (2 L^2))))
[[nodiscard]] inline double lens_change_sigma(double sigma, double displacement_px,
                                              double width_px) {
  constexpr double kCorrelationLength = 0.25;  // image widths
  const double shift = displacement_px / (kCorrelationLength * width_px);
  return sigma * std::sqrt(2 * (1 - std::exp(-0.5 * shift * shift)));
}

}  // namespace stillkite
