#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "estimation/sliding_window/inertial_priors.hpp"
#include "estimation/sliding_window/window.hpp"

// Initialization of a window. Above ground: by height and attitude of the first frame. In motion,
// without either: gyroscope bias and clock offset
// from image rotations, then gravity, velocity and depths by linear least squares, then all
// variables. At rest: by the mean readings of the IMU.

namespace stillkite {

/// Standard deviation of the scale, relative, above which a window is not initialized.
inline constexpr double kMaxScaleSigma_ratio = 0.1;

/// Outcome of an attempt.
struct Initialization {
  bool accepted = false;
  bool is_contradictory =
      false;  ///< the scale would be known, but nothing explains the measurements
  double scale_sigma_ratio = 1;   ///< of the distances between the frames
  double mean_squared_error = 0;  ///< of the reprojections, in variances; 2 is expected
};

/// Sets all states, points and the prior. `world_from_first`: pose of the first frame's IMU, of
/// which gravity corrects roll and pitch. Accepted if the estimation converged, the scale is
/// known to 10 %, the points explain the images, and the accelerometer bias (99 %) and the camera's
/// rotation relative to the IMU (5 sigma) agree with their priors;
/// otherwise only the values have changed, and more frames are needed.
Initialization initialize_in_motion(Window& window, const RigidTransform& world_from_first,
                                    const InertialPriors& priors);

/// As above, by a start above ground: the first frame has its height, and most tracks are on the
/// ground.
Initialization initialize_above_ground(Window& window, const InertialPriors& priors);

/// Standard deviation of a common factor of the distances from the first frame; infinite if the
/// window is not observable.
[[nodiscard]] double scale_sigma_ratio(const Window& window);

/// Standard deviation of the first frame's height above the ground, relative.
[[nodiscard]] double height_sigma_ratio(const Window& window);

/// Rest of the first frame: mean readings of the IMU since it began.
struct InitialRest {
  double duration_s = 0;
  Eigen::Vector3d angular_rate_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_m_s2 = Eigen::Vector3d::Zero();
  double velocity_sigma_m_s = 0;  ///< by the images, per axis

  void add(const ImuInterval& reading);
};

/// Sets the state of a window's only frame: zero velocity, gyroscope bias, roll and pitch by the
/// mean readings; yaw and position are kept.
void initialize_at_rest(Window& window, const InitialRest& rest);

/// Squared deviation of the accelerometer bias from its prior, in variances.
[[nodiscard]] double accel_bias_deviation(const InertialState& state, const InertialPriors& priors);

/// Squared deviation of the camera's rotation from its calibration, in variances of its prior.
[[nodiscard]] double camera_rotation_deviation(const Window& window, const InertialPriors& priors);

/// Prior of a first frame whose position and yaw, once set, define the world; its biases are zero
/// and the extrinsics calibrated, within the priors. `rest`: what the readings of a rest say in
/// addition.
void set_initial_prior(Window& window, const InertialPriors& priors,
                       const std::optional<InitialRest>& rest = {});

}  // namespace stillkite
