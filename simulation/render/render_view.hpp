#pragma once

#include "simulation/render/render_kernel.hpp"
#include "simulation/render/renderer.hpp"

namespace stillkite {

/// Constants of the inner loop for one pose over one ground. Precondition: camera above z = 0.
/// `sample_focal_px`: focal length in samples, which selects the pyramid level.
[[nodiscard]] RenderView make_view(const Scene& scene, const RigidTransform& world_from_camera,
                                   const GroundObjects& objects, double sample_focal_px);

}  // namespace stillkite
