#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/rigid_transform.hpp"
#include "simulation/scene/ground_texture.hpp"

namespace stillkite {

/// Textured rectangle, visible from its front only: the side from which the image is not mirrored.
/// The centre of the first texel is at the corner. Texel size and mirrored repetition are those of
/// GroundTexture.
struct Patch {
  Eigen::Vector3d corner_in_world_m;
  Eigen::Vector3d right_in_world_m;  ///< along the image rows; its norm is the width
  Eigen::Vector3d down_in_world_m;   ///< along the image columns; its norm is the height
  std::shared_ptr<const GroundTexture> texture;
};

/// Three-dimensional scene of textured rectangles over a uniform background.
struct PatchScene {
  std::vector<Patch> patches;
  double background_grey = 200;
};

struct Ray {
  Eigen::Vector3d origin_in_world_m;
  Eigen::Vector3d direction_in_world;
};

/// Ray of a bearing (x, y, 1); its parameter is the depth z in the camera.
[[nodiscard]] Ray ray_of(const RigidTransform& world_from_camera, const Eigen::Vector2d& bearing);

struct PatchHit {
  const Patch* patch;
  double depth;  ///< point = origin + depth x direction
  Eigen::Vector3d point_in_world_m;
};
/// First intersection of a ray with the front of a patch; nullopt without one.
[[nodiscard]] std::optional<PatchHit> first_hit(const PatchScene& scene, const Ray& ray);

/// Depth of the first intersection; nullopt without one.
[[nodiscard]] std::optional<double> depth_at(const PatchScene& scene, const Ray& ray);

/// Grey value of a patch at a point on it, from the finest level.
[[nodiscard]] double grey_at(const Patch& patch, const Eigen::Vector3d& point_in_world_m);

}  // namespace stillkite
