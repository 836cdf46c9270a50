#include "simulation/scene/patch_scene.hpp"

#include <Eigen/Geometry>

namespace stillkite {

Ray ray_of(const RigidTransform& world_from_camera, const Eigen::Vector2d& bearing) {
  return {world_from_camera.translation, world_from_camera.rotation * bearing.homogeneous()};
}

std::optional<PatchHit> first_hit(const PatchScene& scene, const Ray& ray) {
  std::optional<PatchHit> nearest;
  for (const Patch& patch : scene.patches) {
    const Eigen::Vector3d back_normal = patch.right_in_world_m.cross(patch.down_in_world_m);
    const double approach = back_normal.dot(ray.direction_in_world);
    if (!(approach > 0)) continue;
    const double depth =
        back_normal.dot(patch.corner_in_world_m - ray.origin_in_world_m) / approach;
    if (!(depth > 0) || (nearest && nearest->depth <= depth)) continue;
    const Eigen::Vector3d point = ray.origin_in_world_m + depth * ray.direction_in_world;
    const Eigen::Vector3d offset = point - patch.corner_in_world_m;
    const double right = offset.dot(patch.right_in_world_m) / patch.right_in_world_m.squaredNorm();
    const double down = offset.dot(patch.down_in_world_m) / patch.down_in_world_m.squaredNorm();
    if (right < 0 || right > 1 || down < 0 || down > 1) continue;
    nearest = PatchHit{&patch, depth, point};
  }
  return nearest;
}

std::optional<double> depth_at(const PatchScene& scene, const Ray& ray) {
  const std::optional<PatchHit> hit = first_hit(scene, ray);
  return hit ? std::optional(hit->depth) : std::nullopt;
}

double grey_at(const Patch& patch, const Eigen::Vector3d& point_in_world_m) {
  const Eigen::Vector3d offset = point_in_world_m - patch.corner_in_world_m;
  const Eigen::Vector2d from_corner(offset.dot(patch.right_in_world_m.normalized()),
                                    offset.dot(patch.down_in_world_m.normalized()));
  // origin of the texture: its centre; rows towards -y
  const Eigen::Vector2d corner_texel = patch.texture->texel_of(Eigen::Vector2d::Zero());
  const double texel_m = patch.texture->metres_per_texel();
  return patch.texture->grey_at({from_corner.x() - corner_texel.x() * texel_m,
                                 -from_corner.y() + corner_texel.y() * texel_m});
}

}  // namespace stillkite
