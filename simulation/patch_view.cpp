#include "simulation/patch_view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

namespace stillkite {
namespace {

using Functional = std::array<float, 3>;  // of the bearing (x, y, 1)

Functional functional(const Eigen::Vector3d& a) {
  return {static_cast<float>(a.x()), static_cast<float>(a.y()), static_cast<float>(a.z())};
}

float lowest(const Functional& a, const BearingBounds& in) {
  return std::min(a[0] * in.low_x, a[0] * in.high_x) + std::min(a[1] * in.low_y, a[1] * in.high_y) +
         a[2];
}

float highest(const Functional& a, const BearingBounds& in) {
  return std::max(a[0] * in.low_x, a[0] * in.high_x) + std::max(a[1] * in.low_y, a[1] * in.high_y) +
         a[2];
}

// scale a - b
Functional scaled_difference(float scale, const Functional& a, const Functional& b) {
  return {scale * a[0] - b[0], scale * a[1] - b[1], scale * a[2] - b[2]};
}

std::optional<PatchView> view_of(const Patch& patch, const RigidTransform& camera_from_world,
                                 double sample_focal_px) {
  const Eigen::Matrix3d R = camera_from_world.rotation.toRotationMatrix();
  const Eigen::Vector3d corner = camera_from_world * patch.corner_in_world_m;
  const Eigen::Vector3d right = R * patch.right_in_world_m.normalized();
  const Eigen::Vector3d down = R * patch.down_in_world_m.normalized();
  const Eigen::Vector3d away = right.cross(down);
  const double distance_m = away.dot(corner);
  constexpr double kNearest_m = 1e-3;
  if (!(distance_m > kNearest_m)) return std::nullopt;

  // the point on the bearing b is b / (inverse_depth . b), from the corner that minus the corner
  const Eigen::Vector3d inverse_depth = away / distance_m;
  const GroundTexture& texture = *patch.texture;
  const double texel_m = texture.metres_per_texel();
  const double width = patch.right_in_world_m.norm() / texel_m;
  const double height = patch.down_in_world_m.norm() / texel_m;
  const GroundTexture::Level& finest = texture.levels().front();
  return PatchView{.inverse_depth = functional(inverse_depth),
                   .u = functional((right - corner.dot(right) * inverse_depth) / texel_m),
                   .v = functional((down - corner.dot(down) * inverse_depth) / texel_m),
                   .width_texels = static_cast<float>(width),
                   .height_texels = static_cast<float>(height),
                   // an element of the plane z = 1 covers depth^3 / distance of the patch
                   .texels_per_cubed_depth = static_cast<float>(
                       1 / (distance_m * sample_focal_px * sample_focal_px * texel_m * texel_m)),
                   .mirrored = width > finest.width - 1 || height > finest.height - 1,
                   .words = texture.words(),
                   .levels = texture.levels().data(),
                   .level_count = static_cast<int>(texture.levels().size())};
}

enum class Overlap { none, some, all };

Overlap overlap_of(const PatchView& patch, const BearingBounds& bounds) {
  if (highest(patch.inverse_depth, bounds) <= 0) return Overlap::none;
  Overlap overlap =
      bounds.sees_all && lowest(patch.inverse_depth, bounds) > 0 ? Overlap::all : Overlap::some;
  for (const Functional& inside :
       {patch.u, patch.v, scaled_difference(patch.width_texels, patch.inverse_depth, patch.u),
        scaled_difference(patch.height_texels, patch.inverse_depth, patch.v)}) {
    if (highest(inside, bounds) < 0) return Overlap::none;
    if (!(lowest(inside, bounds) > 0)) overlap = Overlap::some;
  }
  return overlap;
}

}  // namespace

std::vector<PatchView> make_patch_views(const PatchScene& scene,
                                        const RigidTransform& world_from_camera,
                                        double sample_focal_px) {
  const RigidTransform camera_from_world = world_from_camera.inverse();
  std::vector<PatchView> views;
  views.reserve(scene.patches.size());
  for (const Patch& patch : scene.patches) {
    const std::optional<PatchView> view = view_of(patch, camera_from_world, sample_focal_px);
    if (view) views.push_back(*view);
  }
  return views;
}

VisiblePatches visible_within(const std::vector<const PatchView*>& patches,
                              const BearingBounds& bounds) {
  VisiblePatches visible;
  const PatchView* cover = nullptr;  // of those that fill the bounds, the surely nearest one
  float cover_inverse_depth = 0;
  for (const PatchView* patch : patches) {
    const Overlap overlap = overlap_of(*patch, bounds);
    if (overlap == Overlap::none) continue;
    visible.patches.push_back(patch);
    const float least = lowest(patch->inverse_depth, bounds);
    if (overlap == Overlap::all && least > cover_inverse_depth) {
      cover = patch;
      cover_inverse_depth = least;
    }
  }
  if (cover) {
    std::erase_if(visible.patches, [&](const PatchView* patch) {
      return patch != cover && highest(patch->inverse_depth, bounds) < cover_inverse_depth;
    });
  }
  visible.covered = cover && visible.patches.size() == 1;
  return visible;
}

}  // namespace stillkite
