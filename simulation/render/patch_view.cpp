#include "simulation/render/patch_view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace stillkite {
namespace {

using Functional = std::array<float, 3>;  // linear function of the bearing (x, y, 1)

Functional functional(const Eigen::Vector3d& a) {
  return {static_cast<float>(a.x()), static_cast<float>(a.y()), static_cast<float>(a.z())};
}

struct Span {
  float low = 0;
  float high = 0;
};

// Range of a linear function over a rectangle of bearings.
Span span_of(const Functional& a, const BearingBounds& bounds) {
  const float middle = a[0] * bounds.centre_x + a[1] * bounds.centre_y + a[2];
  const float reach = std::abs(a[0]) * bounds.reach_x + std::abs(a[1]) * bounds.reach_y;
  return {middle - reach, middle + reach};
}

// scale a - b
Functional scaled_difference(float scale, const Functional& a, const Functional& b) {
  return {scale * a[0] - b[0], scale * a[1] - b[1], scale * a[2] - b[2]};
}

PatchLevel level_of(const GroundTexture& texture, int number) {
  const GroundTexture::Level& level = texture.levels()[number];
  const float scale = std::ldexp(1.0F, -number);
  return {.scale = scale,
          .shift = 0.5F * scale - 0.5F,
          .last_u = static_cast<float>(level.width - 1),
          .last_v = static_cast<float>(level.height - 1),
          .pitch = 2 * static_cast<std::uint32_t>(level.pitch),
          .offset = 2 * static_cast<std::uint32_t>(level.offset)};
}

std::optional<PatchView> view_of(const Patch& patch, const RigidTransform& camera_from_world,
                                 double focal_px) {
  const Eigen::Matrix3d R = camera_from_world.rotation.toRotationMatrix();
  const Eigen::Vector3d corner = camera_from_world * patch.corner_in_world_m;
  const Eigen::Vector3d right = R * patch.right_in_world_m.normalized();
  const Eigen::Vector3d down = R * patch.down_in_world_m.normalized();
  const Eigen::Vector3d back_normal = right.cross(down);
  const double distance_m = back_normal.dot(corner);
  constexpr double kMinDistance_m = 1e-3;
  if (!(distance_m > kMinDistance_m)) return std::nullopt;

  // point along b: b / (inverse_depth . b); texel: its offset from the corner along right and down
  const Eigen::Vector3d inverse_depth = back_normal / distance_m;
  const GroundTexture& texture = *patch.texture;
  const double texel_m = texture.metres_per_texel();
  const double width = patch.right_in_world_m.norm() / texel_m;
  const double height = patch.down_in_world_m.norm() / texel_m;
  const GroundTexture::Level& finest = texture.levels().front();
  PatchView view{.inverse_depth = functional(inverse_depth),
                 .u = functional((right - corner.dot(right) * inverse_depth) / texel_m),
                 .v = functional((down - corner.dot(down) * inverse_depth) / texel_m),
                 .width_texels = static_cast<float>(width),
                 .height_texels = static_cast<float>(height),
                 // area of the patch per area of the plane z = 1: depth^3 / distance
                 .texels_per_cubed_depth =
                     static_cast<float>(1 / (distance_m * focal_px * focal_px * texel_m * texel_m)),
                 .mirrored = width > finest.width - 1 || height > finest.height - 1,
                 .pairs = texture.pairs()};
  view.level_count = static_cast<int>(std::min(texture.levels().size(), view.levels.size()));
  for (int number = 0; number < view.level_count; ++number) {
    view.levels[number] = level_of(texture, number);
  }
  return view;
}

enum class Overlap { none, some, all };

Overlap overlap_of(const PatchView& patch, const Span& inverse_depth, const BearingBounds& bounds) {
  if (inverse_depth.high <= 0) return Overlap::none;
  bool all = bounds.all_valid && inverse_depth.low > 0;
  for (const Functional& inside :
       {patch.u, patch.v, scaled_difference(patch.width_texels, patch.inverse_depth, patch.u),
        scaled_difference(patch.height_texels, patch.inverse_depth, patch.v)}) {
    const Span span = span_of(inside, bounds);
    if (span.high < 0) return Overlap::none;
    all = all && span.low > 0;
  }
  return all ? Overlap::all : Overlap::some;
}

}  // namespace

std::vector<PatchView> make_patch_views(const PatchScene& scene,
                                        const RigidTransform& world_from_camera, double focal_px) {
  const RigidTransform camera_from_world = world_from_camera.inverse();
  std::vector<PatchView> views;
  views.reserve(scene.patches.size());
  for (const Patch& patch : scene.patches) {
    const std::optional<PatchView> view = view_of(patch, camera_from_world, focal_px);
    if (view) views.push_back(*view);
  }
  return views;
}

VisiblePatches visible_within(const std::vector<PatchCandidate>& patches,
                              const BearingBounds& bounds) {
  VisiblePatches visible;
  visible.patches.reserve(patches.size());
  const PatchView* cover = nullptr;  // patch that fills the bounds, with the smallest maximum depth
  float cover_inverse_depth = 0;
  for (const PatchCandidate& patch : patches) {
    const Span inverse_depth = span_of(patch.view->inverse_depth, bounds);
    const Overlap overlap = overlap_of(*patch.view, inverse_depth, bounds);
    if (overlap == Overlap::none) continue;
    visible.patches.push_back({patch.view, inverse_depth.low, inverse_depth.high});
    if (overlap == Overlap::all && inverse_depth.low > cover_inverse_depth) {
      cover = patch.view;
      cover_inverse_depth = inverse_depth.low;
    }
  }
  if (cover) {
    std::erase_if(visible.patches, [&](const PatchCandidate& patch) {
      return patch.view != cover && patch.max_inverse_depth < cover_inverse_depth;
    });
  }
  visible.covered = cover && visible.patches.size() == 1;
  return visible;
}

std::vector<PatchCandidate> candidates_of(const std::vector<PatchView>& views) {
  std::vector<PatchCandidate> candidates;
  candidates.reserve(views.size());
  for (const PatchView& view : views) candidates.push_back({.view = &view});
  return candidates;
}

}  // namespace stillkite
