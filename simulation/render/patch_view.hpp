#pragma once

#include <vector>

#include "geometry/rigid_transform.hpp"
#include "simulation/render/patch_kernel.hpp"
#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// The patches whose front one camera may see. `focal_px` gives the pyramid level: a texel
/// of it is about a pixel.
[[nodiscard]] std::vector<PatchView> make_patch_views(const PatchScene& scene,
                                                      const RigidTransform& world_from_camera,
                                                      double focal_px);

/// The rectangle of the plane z = 1 in which the bearings of some samples lie.
struct BearingBounds {
  float centre_x = 0;
  float centre_y = 0;
  float reach_x = 0;  ///< to either side
  float reach_y = 0;
  bool sees_all = true;  ///< no sample that the lens cannot see
};

/// Those that may be the nearest somewhere within the bounds, without those that one of them hides
/// everywhere.
struct VisiblePatches {
  std::vector<PatchCandidate> patches;
  bool covered = false;  ///< there is one only, and it fills the bounds
};
[[nodiscard]] VisiblePatches visible_within(const std::vector<PatchCandidate>& patches,
                                            const BearingBounds& bounds);

/// All of them, at any depth.
[[nodiscard]] std::vector<PatchCandidate> candidates_of(const std::vector<PatchView>& views);

}  // namespace stillkite
