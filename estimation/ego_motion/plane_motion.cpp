#include "estimation/ego_motion/plane_motion.hpp"

#include "geometry/rigid_transform.hpp"

namespace stillkite {

PlaneMotion apply(const PlaneMotion& motion, const PlaneMotionStep& step,
                  const TiltAxes& tilt_axes) {
  const Eigen::Quaterniond rotation = so3_exp(step.segment<3>(3));
  const Eigen::Quaterniond tilt = so3_exp(tilt_axes * step.tail<2>());
  return {.rotation = (rotation * motion.rotation).normalized(),
          .translation = rotation * motion.translation + step.head<3>(),
          .normal = (tilt * motion.normal).normalized()};
}

}  // namespace stillkite
