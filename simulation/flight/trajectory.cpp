#include "simulation/flight/trajectory.hpp"

#include <cmath>

#include "geometry/euler.hpp"

namespace stillkite {

Jet Signal::at(double t_s) const {
  Jet jet{offset + slope * t_s, slope, 0};
  for (const Sine& sine : sines) {
    const double angle = sine.frequency_rad_s * t_s + sine.phase_rad;
    const double value = sine.amplitude * std::sin(angle);
    jet.value += value;
    jet.rate += sine.amplitude * sine.frequency_rad_s * std::cos(angle);
    jet.acceleration -= sine.frequency_rad_s * sine.frequency_rad_s * value;
  }
  return jet;
}

Jet time_after_rest(double t_s, double rest_s) {
  const double x = (t_s - rest_s) / kStart_s;
  if (x <= 0) return {0, 0, 0};
  if (x >= 1) return {t_s - rest_s - 0.5 * kStart_s, 1, 0};
  return {kStart_s * x * x * x * (1 - 0.5 * x), x * x * (3 - 2 * x), 6 * x * (1 - x) / kStart_s};
}

// x(s(t)): velocity x' s', acceleration x'' s'^2 + x' s''.
MotionState Trajectory::at(double t_s) const {
  if (rest_s == 0) return in_motion_at(t_s);
  const Jet time = time_after_rest(t_s, rest_s);
  MotionState state = in_motion_at(time.value);
  state.acceleration_in_world_m_s2 = time.rate * time.rate * state.acceleration_in_world_m_s2 +
                                     time.acceleration * state.velocity_in_world_m_s;
  state.velocity_in_world_m_s *= time.rate;
  state.angular_rate_in_body_rad_s *= time.rate;
  return state;
}

MotionState Trajectory::in_motion_at(double t_s) const {
  const Jet x = x_m.at(t_s);
  const Jet y = y_m.at(t_s);
  const Jet z = z_m.at(t_s);
  const Jet yaw = yaw_rad.at(t_s);
  const Jet pitch = pitch_rad.at(t_s);
  const Jet roll = roll_rad.at(t_s);

  const double sr = std::sin(roll.value);
  const double cr = std::cos(roll.value);
  const double sp = std::sin(pitch.value);
  const double cp = std::cos(pitch.value);
  return {.world_from_body = {to_quaternion({yaw.value, pitch.value, roll.value}),
                              {x.value, y.value, z.value}},
          .velocity_in_world_m_s = {x.rate, y.rate, z.rate},
          .acceleration_in_world_m_s2 = {x.acceleration, y.acceleration, z.acceleration},
          // inverse of euler_rates
          .angular_rate_in_body_rad_s = {roll.rate - sp * yaw.rate,
                                         cr * pitch.rate + sr * cp * yaw.rate,
                                         -sr * pitch.rate + cr * cp * yaw.rate}};
}

}  // namespace stillkite
