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

MotionState Trajectory::at(double t_s) const {
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
