#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/rigid_transform.hpp"
#include "simulation/scene/ground_texture.hpp"

namespace stillkite {

/// A rectangle in space with an image on it. Only its front is seen: the side from which the
/// image reads from left to right. The centre of the image's first texel is at `corner`, its
/// texels have the texture's metres, and beyond its borders it goes on as its mirror image.
struct Patch {
  Eigen::Vector3d corner_in_world_m;
  Eigen::Vector3d right_in_world_m;  ///< along the image's rows, the rectangle's whole width
  Eigen::Vector3d down_in_world_m;   ///< along its columns, the whole height
  std::shared_ptr<const GroundTexture> texture;
};

/// What there is to see where the ground alone is too little: things at different depths.
struct PatchScene {
  std::vector<Patch> patches;
  double background_grey = 200;
};

struct Ray {
  Eigen::Vector3d origin_in_world_m;
  Eigen::Vector3d direction_in_world;
};

/// The ray of a bearing (x, y, 1): its parameter is the depth z in the camera.
[[nodiscard]] Ray ray_of(const RigidTransform& world_from_camera, const Eigen::Vector2d& bearing);

/// Where a ray first meets a patch.
struct PatchHit {
  const Patch* patch;
  double depth;  ///< the point is origin + depth x direction
  Eigen::Vector3d point_in_world_m;
};
[[nodiscard]] std::optional<PatchHit> first_hit(const PatchScene& scene, const Ray& ray);

[[nodiscard]] std::optional<double> depth_at(const PatchScene& scene, const Ray& ray);

/// Grey value of the image on a patch at a point of it, from the finest level.
[[nodiscard]] double grey_at(const Patch& patch, const Eigen::Vector3d& point_in_world_m);

}  // namespace stillkite
