#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "geometry/camera.hpp"

namespace stillkite {

/// Points of the image, from left to right, where the camera sees the horizon, through the
/// lens; empty when it is out of the image.
[[nodiscard]] std::vector<Eigen::Vector2d> horizon_pixels(
    const Camera& camera, const Eigen::Quaterniond& world_from_camera);

/// Where the camera sees what lies in that direction; nothing when it is out of the image.
[[nodiscard]] std::optional<Eigen::Vector2d> direction_pixel(
    const Camera& camera, const Eigen::Vector3d& direction_in_camera);

}  // namespace stillkite
