#pragma once

#include "estimation/ego_motion/plane_motion.hpp"
#include "estimation/plane/plane_solver.hpp"

namespace stillkite {

/// Unfiltered plane-alignment measurement of the camera relative to its keyframe.
struct KeyframeView {
  PlaneMotion motion;  ///< keyframe to current; unit of length: height of the keyframe
  TiltAxes tilt_axes = TiltAxes::Identity();
  PlaneLikelihood likelihood;  ///< without the tilt prior
  PlaneLikelihood measured;    ///< the same with smooth errors as the residuals show them
};

}  // namespace stillkite
