#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "geometry/camera.hpp"
#include "io/setup/setup_finding.hpp"

// Questions about the calibration. Bounds: docs/check.md.

namespace stillkite {

class ImageMask;

/// The camera of images scaled to `width_px`; nullopt if the aspect ratio differs by more than half
/// a pixel of the height.
[[nodiscard]] std::optional<Camera> scaled_to(const Camera& camera, int width_px, int height_px);

/// Resolution of the calibration against the images'.
[[nodiscard]] SetupFinding resolution_finding(const Camera& camera, int width_px, int height_px);

/// Lens model one-to-one over the image (`check_lens`). `mask` may be null.
[[nodiscard]] SetupFinding lens_finding(const Camera& camera, const ImageMask* mask,
                                        const std::string& origin);

/// Message if mount and attitude show no ground in the initial image.
[[nodiscard]] std::optional<std::string> no_ground_in_view(
    const Camera& camera, const Eigen::Quaterniond& world_from_camera);

}  // namespace stillkite
