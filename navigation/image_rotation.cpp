#include "navigation/image_rotation.hpp"

#include <utility>

#include "geometry/rigid_transform.hpp"

namespace stillkite {

std::optional<Eigen::Vector3d> ImageRotation::update(const std::optional<KeyframeView>& view,
                                                     bool is_keyframe, double dt_s) {
  std::optional<Eigen::Quaterniond> now;
  if (view) now = view->motion.rotation;
  const std::optional<Eigen::Quaterniond> next =
      is_keyframe ? std::optional(Eigen::Quaterniond::Identity()) : now;
  const std::optional<Eigen::Quaterniond> before = std::exchange(camera_from_keyframe_, next);
  if (!before || !now || !(dt_s > 0)) return std::nullopt;
  return Eigen::Vector3d(so3_log(*before * now->conjugate()) / dt_s);
}

}  // namespace stillkite
