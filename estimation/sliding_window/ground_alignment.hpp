#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "estimation/plane/keyframe_view.hpp"
#include "estimation/sliding_window/reprojection_factor.hpp"
#include "estimation/sliding_window/window_ground.hpp"

namespace stillkite {

/// Dense alignment of an image to a keyframe over the ground plane, in information form: the
/// camera's motion (translation in heights of the keyframe, rotation vector) for a normal of the
/// ground, and the normal. Motions in axes of the keyframe's camera.
struct GroundAlignment {
  std::int64_t keyframe_id = 0;
  std::int64_t frame_id = 0;
  bool is_link = false;  ///< the frame is the next keyframe of the ground
  PlaneMotion motion;
  TiltAxes tilt_axes = TiltAxes::Identity();
  Matrix6d information = Matrix6d::Zero();  ///< of the motion, for a normal
  Eigen::Matrix<double, 6, 2> motion_by_tilt = Eigen::Matrix<double, 6, 2>::Zero();
  Eigen::Matrix2d tilt_information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d tilt_information_rad = Eigen::Vector2d::Zero();  ///< times the likeliest tilt
};

/// Not finite if the view does not determine the motion.
[[nodiscard]] GroundAlignment ground_alignment(const KeyframeView& view, std::int64_t keyframe_id,
                                               std::int64_t frame_id);

/// Motion as aligned minus the motion of a camera pair over a ground, for that ground's normal.
struct GroundAlignmentResidual {
  Vector6d motion;
  Eigen::Vector2d tilt_rad;  ///< of the ground's normal from the alignment's
  Vector6d by_log_height;    ///< of the motion, for a ground closer to the keyframe
};
[[nodiscard]] GroundAlignmentResidual ground_alignment_residual(const GroundAlignment& alignment,
                                                                const CameraPair& pair,
                                                                const GroundView& ground);

/// Decrease of the residual's motion, and increase of its tilt, by the errors of the camera pair
/// (PairError) and of the ground in the keyframe (normal, height).
struct GroundAlignmentJacobians {
  Matrix6d motion_by_pair;
  Eigen::Matrix<double, 6, 4> motion_by_ground;
  Eigen::Matrix<double, 2, 4> tilt_by_ground;
};
[[nodiscard]] GroundAlignmentJacobians ground_alignment_jacobians(const GroundAlignment& alignment,
                                                                  const GroundView& ground);

}  // namespace stillkite
