#pragma once

#include <span>
#include <vector>

#include "geometry/time.hpp"
#include "io/setup/image_statistics.hpp"
#include "io/setup/setup_finding.hpp"

// Questions about the images alone. Bounds: docs/check.md.

namespace stillkite {

[[nodiscard]] SetupFinding sharpness_finding(const ImageStatistics& images);

[[nodiscard]] SetupFinding exposure_finding(const ImageStatistics& images);

[[nodiscard]] SetupFinding texture_finding(const ImageStatistics& images);

/// Exposure time by the motion blur: a blur of the length b = speed x exposure along the
/// displacement reduces the mean squared gradient along it by the factor 1 - (b^2 / 12) q / g, with
/// the mean squares q and g of the second and first derivative along it, and the one across by
/// 1 - (b^2 / 12) m / h, with those of the mixed derivative and of the first one across. Slope of
/// their ratio over the squared displacement.
[[nodiscard]] SetupFinding shutter_finding(std::span<const ImageGradients> frames,
                                           double frame_interval_s);

/// Stamps of consecutive frames: as recorded, and without their jitter.
struct FrameStamps {
  std::vector<Timestamp> recorded, filtered;
};
[[nodiscard]] SetupFinding frame_rate_finding(const FrameStamps& stamps);

/// Image displacement between frames, in pixels.
[[nodiscard]] SetupFinding displacement_finding(std::vector<double> displacements_px, int width_px);

}  // namespace stillkite
