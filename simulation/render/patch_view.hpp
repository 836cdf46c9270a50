#pragma once

#include <vector>

#include "geometry/rigid_transform.hpp"
#include "simulation/render/patch_kernel.hpp"
#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// Projections of the patches that face the camera. `focal_px` selects the pyramid level at which a
/// texel is about one pixel.
[[nodiscard]] std::vector<PatchView> make_patch_views(const PatchScene& scene,
                                                      const RigidTransform& world_from_camera,
                                                      double focal_px);

/// Bounding rectangle of the bearings of several samples in the plane z = 1.
struct BearingBounds {
  float centre_x = 0;
  float centre_y = 0;
  float reach_x = 0;  ///< half width
  float reach_y = 0;
  bool all_valid = true;  ///< every sample is inside the lens's field of view
};

/// Patches that may be the nearest somewhere within the bounds; fully occluded ones are removed.
struct VisiblePatches {
  std::vector<PatchCandidate> patches;
  bool covered = false;  ///< a single patch, which fills the bounds
};
[[nodiscard]] VisiblePatches visible_within(const std::vector<PatchCandidate>& patches,
                                            const BearingBounds& bounds);

/// All patches, with unbounded depth.
[[nodiscard]] std::vector<PatchCandidate> candidates_of(const std::vector<PatchView>& views);

}  // namespace stillkite
