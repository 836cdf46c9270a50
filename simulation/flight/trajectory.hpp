#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Value and first two time derivatives.
struct Jet {
  double value = 0;
  double rate = 0;
  double acceleration = 0;
};

/// offset + slope t + sum of amplitude sin(frequency t + phase), with exact derivatives.
struct Signal {
  struct Sine {
    double amplitude = 0;
    double frequency_rad_s = 0;
    double phase_rad = 0;
  };
  double offset = 0;
  double slope = 0;
  std::vector<Sine> sines{};

  [[nodiscard]] Jet at(double t_s) const;
};

struct MotionState {
  RigidTransform world_from_body;
  Eigen::Vector3d velocity_in_world_m_s;
  Eigen::Vector3d acceleration_in_world_m_s2;
  Eigen::Vector3d angular_rate_in_body_rad_s;
};

/// Duration of the start from rest.
inline constexpr double kStart_s = 1;

/// Time s(t) along a trajectory that rests until `rest_s`. In the following second its rate rises
/// from 0 to 1 as 3 x^2 - 2 x^3, which takes 0.5 s of the trajectory.
[[nodiscard]] Jet time_after_rest(double t_s, double rest_s);

/// Analytic trajectory: exact pose, velocity, acceleration and angular rate at any time.
/// Euler angles as in geometry/euler.hpp: ZYX, positive pitch is nose down.
struct Trajectory {
  Signal x_m;
  Signal y_m;
  Signal z_m;
  Signal yaw_rad;
  Signal pitch_rad;
  Signal roll_rad;
  double rest_s = 0;  ///< initial rest; 0: starts in motion

  [[nodiscard]] MotionState at(double t_s) const;

 private:
  [[nodiscard]] MotionState in_motion_at(double t_s) const;
};

}  // namespace stillkite
