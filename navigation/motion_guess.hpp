#pragma once

#include <vector>

#include "estimation/ego_motion/motion_filter.hpp"
#include "estimation/ego_motion/plane_motion.hpp"
#include "flow/image_search.hpp"
#include "geometry/camera.hpp"

namespace stillkite {

/// Standard deviation of the place, px, at which a filter expects what the optical axis meets: how
/// far off an alignment that starts from this prediction may have to reach.
[[nodiscard]] double prediction_sigma_px(const Camera& camera, const MotionFilter& filter);

/// A view of the ground from straight above, as far as the camera's tilt allows: over it a way
/// parallel to the ground is one shift of the whole image. Lens distortion is left out.
struct LevelView {
  Eigen::Quaterniond view_from_camera = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();  ///< of the view; the middle stays the middle
  Eigen::Matrix3d homography = Eigen::Matrix3d::Identity();  ///< to the view, px
};
[[nodiscard]] LevelView level_view(const Camera& camera, const Eigen::Vector3d& normal);

/// The motions that shift the view's middle as seen, over a plane of this normal (camera axes): by
/// a way parallel to the plane, and by a turn alone.
[[nodiscard]] std::vector<PlaneMotion> motions_of(const ImageShift& shift, const Camera& camera,
                                                  const LevelView& view,
                                                  const Eigen::Vector3d& normal);

}  // namespace stillkite
