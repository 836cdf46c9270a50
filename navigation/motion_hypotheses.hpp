#pragma once

#include <vector>

#include "estimation/ego_motion/multiple_model_filter.hpp"
#include "estimation/ego_motion/plane_motion.hpp"
#include "flow/image_registration.hpp"
#include "geometry/camera.hpp"

namespace stillkite {

/// Standard deviation, px, of the predicted image position of the point on the optical axis: the
/// convergence range that an alignment from this prediction needs.
[[nodiscard]] double prediction_sigma_px(const Camera& camera, const MultipleModelFilter& filter);

/// Virtual nadir view of the ground, within a maximum tilt of the camera: in it, a translation
/// parallel to the ground shifts the image as a whole. Lens distortion is neglected.
struct NadirView {
  Eigen::Quaterniond view_from_camera = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();  ///< intrinsics; the image centre is kept
  Eigen::Matrix3d homography = Eigen::Matrix3d::Identity();  ///< from image to view, px
};
[[nodiscard]] NadirView nadir_view(const Camera& camera, const Eigen::Vector3d& normal);

/// Motions that explain the registered shift of the view's centre over a plane with this normal
/// (camera axes): a translation parallel to the plane, and a rotation alone.
[[nodiscard]] std::vector<PlaneMotion> motion_hypotheses(const ImageRegistration& registration,
                                                         const Camera& camera,
                                                         const NadirView& view,
                                                         const Eigen::Vector3d& normal);

}  // namespace stillkite
