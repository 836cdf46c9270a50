#pragma once

#include "estimation/ego_motion/plane_motion.hpp"
#include "estimation/plane/plane_solver.hpp"

namespace stillkite {

/// The camera over the ground as the flow sees it from its keyframe, before any filter.
struct KeyframeView {
  PlaneMotion motion;  ///< lengths in heights of the keyframe
  TiltAxes tilt_axes = TiltAxes::Identity();
  WindowsAlone windows;
};

}  // namespace stillkite
