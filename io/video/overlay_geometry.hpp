#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "geometry/camera.hpp"

namespace stillkite {

/// Pixels of the horizon through the lens model, from left to right; empty if outside the image.
[[nodiscard]] std::vector<Eigen::Vector2d> horizon_pixels(
    const Camera& camera, const Eigen::Quaterniond& world_from_camera);

/// Pixel of a direction; nullopt if outside the image or behind the camera.
[[nodiscard]] std::optional<Eigen::Vector2d> direction_pixel(
    const Camera& camera, const Eigen::Vector3d& direction_in_camera);

}  // namespace stillkite
