#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "estimation/fusion/running_ratio.hpp"
#include "geometry/angle.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// What is estimated of the camera. The world is the one of the first frame: its pose there is
/// exact, gravity is not. Lengths are in map units; one is exp(log_scale) metres, so that what no
/// metric sensor tells is one number, and the view of the landmarks does not depend on it.
struct FusionState {
  RigidTransform world_from_camera;                             ///< map units
  Eigen::Vector3d velocity_in_world = Eigen::Vector3d::Zero();  ///< map units/s
  /// Gained of late, world axes, and not yet counted among what is wrong with the scale.
  Eigen::Vector3d recent_gain_m_s = Eigen::Vector3d::Zero();
  double mean_square_acceleration_m2_s4 = 0;  ///< of what was counted, over the last second
  Eigen::Vector3d gyro_bias_rad_s = Eigen::Vector3d::Zero();   ///< camera axes
  Eigen::Vector3d accel_bias_m_s2 = Eigen::Vector3d::Zero();   ///< camera axes
  Eigen::Vector2d gravity_tilt_rad = Eigen::Vector2d::Zero();  ///< about world x and y
  double log_scale = 0;
  double log_height = 0;               ///< of the known height at the start over the true one
  RigidTransform world_from_anchor;    ///< the camera at the reference frame
  RigidTransform world_from_keyframe;  ///< the camera at the flow's keyframe
  Eigen::Vector3d step_start;          ///< where the camera was at the frame before, map units
};

/// What is known of the first frame.
struct FusionStart {
  RigidTransform world_from_camera;     ///< z is the height over the ground
  double velocity_sigma = 0;            ///< units/s
  double tilt_sigma_rad = 1 * kDegree;  ///< of its roll and pitch against gravity
  /// Of the logarithm of that pose's unit in metres. 0: it is metres.
  double log_unit_sigma = 0;
};

/// The world's true vertical: exp(tilt) z, to first order.
[[nodiscard]] inline Eigen::Vector3d up(const FusionState& state) {
  return {state.gravity_tilt_rad.y(), -state.gravity_tilt_rad.x(), 1};
}

/// A point in space, seen from the anchor at (x, y, 1) / inverse depth.
struct Landmark {
  int feature = 0;          ///< its number in the reference
  Eigen::Vector2d bearing;  ///< on z = 1 of the anchor, with what its window is off by now
  /// The same, as its window lies in the reference.
  Eigen::Vector2d reference = Eigen::Vector2d::Zero();
  double inverse_depth = 0;   ///< 1 / map units
  bool is_guess = false;      ///< its depth, by no view yet
  bool is_of_start = false;   ///< its depth, by the images of the start as a whole
  bool is_on_ground = false;  ///< taken for it, once
  int refused = 0;            ///< views in a row that the gate refused, or that no point has
  int unseen = 0;             ///< frames in a row that had no view of it
  /// What its views are off by, squared, over what others of their frames are: what no point is.
  RunningRatio stray;
  bool is_spare = false;  ///< taken up because most others are out of view
  /// Of the camera from the anchor when it was last seen; world axes, map units.
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
};

/// A reference frame that was left, to be used again when it comes back into view.
struct FusionMap {
  Eigen::Vector2d gravity_tilt_rad = Eigen::Vector2d::Zero();
  double log_scale = 0;  ///< lengths that go from map to map drift; these were this map's
  double log_height = 0;
  RigidTransform world_from_anchor;
  std::vector<Landmark> landmarks;
  std::vector<int> dropped;    ///< features that are to be no landmarks (`FusionFilter::dropped`)
  Eigen::MatrixXd covariance;  ///< (tilt, scale, height, anchor's pose, landmarks)
};

/// Where the errors of FusionState begin in the error vector; then three a landmark (bearing,
/// inverse depth). Rotation errors are in world axes: R_true = exp(e) R.
struct FusionIndex {
  static constexpr int kRotation = 0;
  static constexpr int kPosition = 3;
  static constexpr int kVelocity = 6;
  static constexpr int kGyroBias = 9;
  static constexpr int kAccelBias = 12;
  static constexpr int kTilt = 15;
  static constexpr int kScale = 17;
  static constexpr int kHeight = 18;
  static constexpr int kAnchorRotation = 19;
  static constexpr int kAnchorPosition = 22;
  static constexpr int kKeyframeRotation = 25;
  static constexpr int kKeyframePosition = 28;
  static constexpr int kStepStart = 31;
  static constexpr int kLandmarks = 34;
  /// Of the i-th landmark's.
  [[nodiscard]] static int landmark(std::size_t i) { return kLandmarks + 3 * static_cast<int>(i); }
};

}  // namespace stillkite
