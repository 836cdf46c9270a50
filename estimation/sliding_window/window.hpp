#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cstdint>
#include <optional>
#include <vector>

#include "estimation/sliding_window/ground_alignment.hpp"
#include "estimation/sliding_window/ground_relief.hpp"
#include "estimation/sliding_window/imu_timeline.hpp"
#include "estimation/sliding_window/reprojection_factor.hpp"
#include "estimation/sliding_window/window_ground.hpp"
#include "geometry/time.hpp"

namespace stillkite {

/// Image of the window. A keyframe that is older than the IMU chain has a pose only.
struct WindowFrame {
  std::int64_t id = 0;
  Timestamp stamp;
  InertialState state;
  /// Linearization point of the Jacobians once the marginal prior depends on this frame.
  std::optional<InertialState> first_estimate;
  ImuPreintegration imu;                                 ///< since the previous frame of the chain
  Eigen::Vector3d gyro_rad_s = Eigen::Vector3d::Zero();  ///< reading at this frame
  std::optional<double> rest_sigma_m_s;                  ///< zero velocity is measured, per axis
  bool has_motion = true;                                ///< velocity and biases are states
  bool is_keyframe = false;

  [[nodiscard]] const InertialState& linearization() const {
    return first_estimate ? *first_estimate : state;
  }
  /// Pose a time after the state's.
  [[nodiscard]] RigidTransform world_from_imu_after(double shift_s, bool at_first_estimate) const;
  /// Rate of the pose's error, order of InertialIndex.
  [[nodiscard]] Vector6d pose_rate() const;
  [[nodiscard]] int size() const {
    return has_motion ? InertialIndex::kSize : InertialIndex::kPoseSize;
  }
};

/// Bearing of a feature in one image.
struct WindowObservation {
  std::int64_t frame_id = 0;
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();          ///< on z = 1
  Eigen::Matrix2d information = Eigen::Matrix2d::Identity();  ///< inverse covariance

  /// Mean variance of the two components.
  [[nodiscard]] double variance() const {
    return 0.5 * information.trace() / information.determinant();
  }
};

/// Feature of the window; the first observation is in a keyframe, the point's first keyframe.
struct WindowTrack {
  std::int64_t id = 0;
  std::vector<WindowObservation> observations;
  std::optional<InverseDepthPoint> point;  ///< empty until triangulated
  /// Of the point's height above the ground, over its depth; 0: not on the ground.
  double ground_information = 0;
  bool is_ground_marginalized = false;  ///< the prior has it

  /// Observation in a frame; null if there is none.
  [[nodiscard]] const WindowObservation* in(std::int64_t frame_id) const;
};

/// Prior from marginalized variables: cost 1/2 d^T H d - g^T d of the error d from the first
/// estimates, over all variables of the window in their order.
struct MarginalPrior {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

/// Variables that do not belong to a frame; those of the frames follow.
struct SharedIndex {
  static constexpr int kExtrinsics = 0;
  static constexpr int kGround = ExtrinsicsIndex::kSize;
  static constexpr int kSize = kGround + GroundIndex::kSize;
};

/// Pose of the first frame above the ground, before any measurement.
struct StartAboveGround {
  RigidTransform world_from_imu;
  double height_sigma_m = 0;
  std::optional<double> tilt_sigma_rad;   ///< of roll and pitch; empty: unknown
  std::optional<double> level_slope_rad;  ///< sigma of a level ground; empty: none is level
  GroundRelief relief;
  bool is_level = false;  ///< the measured slope is that of a level ground

  /// Standard deviation of the ground's slope, per axis.
  [[nodiscard]] double slope_sigma() const {
    constexpr double kBeach = 0.05;  // one in twenty
    return is_level ? *level_slope_rad : kBeach;
  }
};

/// Variables, measurements and prior of a fixed-lag smoother (Leutenegger et al. 2015; Usenko et
/// al. 2020). Order of the variables: SharedIndex, then frames by time.
struct Window {
  CameraExtrinsics calibrated;
  CameraExtrinsics extrinsics;  ///< estimate
  CameraExtrinsics
      first_extrinsics;       ///< linearization point; its clock offset sets the states' times
  WindowGround ground;        ///< estimate
  WindowGround first_ground;  ///< linearization point
  /// Empty if the height is unknown: no point is taken to be on the ground.
  std::optional<StartAboveGround> start;
  ImuTimeline imu;
  std::vector<WindowFrame> frames;
  std::vector<WindowTrack> tracks;  ///< by ascending number
  /// To keyframes of the ground; grouped by keyframe, both by ascending number.
  std::vector<GroundAlignment> alignments;
  MarginalPrior prior;
  /// Keyframe that stays, so that a return to it corrects what has drifted since.
  std::int64_t reference_id = -1;
  /// Keyframe to which images are aligned over the ground; -1: none.
  std::int64_t ground_keyframe_id = -1;

  /// Time of a frame's state in the IMU's clock.
  [[nodiscard]] Timestamp imu_time(Timestamp image) const;
  /// Time of the images after their states, by which the clock's offset differs from its first
  /// estimate.
  [[nodiscard]] double image_shift_s() const {
    return extrinsics.time_offset_s - first_extrinsics.time_offset_s;
  }
  /// First variable of each frame; the last entry is the number of variables.
  [[nodiscard]] std::vector<int> offsets() const;
  /// Position in `frames`; empty if the frame was removed.
  [[nodiscard]] std::optional<std::size_t> find(std::int64_t frame_id) const;
};

/// Appends a frame; the prior does not depend on it.
void append_frame(Window& window, WindowFrame frame);

/// Takes the IMU readings between the previous frame and this one again.
void integrate_imu(Window& window, std::size_t frame);

/// Moves all frames by a rotation about the vertical and a translation: position `from` becomes
/// `to`. No measurement of the window depends on either.
void move_window(Window& window, const Eigen::Quaterniond& yaw, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to);

/// Moves the first estimates of positions, velocities and height above the ground, in which the
/// prior is linear, as the window has moved since: by a displacement and a common factor. The prior
/// stays the same function.
void move_first_estimates(Window& window);

/// Makes the present extrinsics and ground the linearization point, with the states at the times of
/// the images. All frames have a motion, and the prior does not depend on them.
void linearize_at_present(Window& window);

}  // namespace stillkite
