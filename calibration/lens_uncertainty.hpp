#pragma once

#include "calibration/lens_fit.hpp"

namespace stillkite {

/// Standard deviation of the image displacement by the errors of the lens parameters: RMS of its
/// length over the image, less the displacement that a rotation of the camera explains.
[[nodiscard]] double lens_sigma_px(const LensFit& fit);

}  // namespace stillkite
