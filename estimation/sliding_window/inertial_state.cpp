#include "estimation/sliding_window/inertial_state.hpp"

namespace stillkite {

InertialState plus(const InertialState& state, const InertialError& error) {
  InertialState out = state;
  RigidTransform& pose = out.world_from_imu;
  pose.rotation =
      (pose.rotation * so3_exp(error.segment<3>(InertialIndex::kRotation))).normalized();
  pose.translation += error.segment<3>(InertialIndex::kPosition);
  out.velocity_in_world_m_s += error.segment<3>(InertialIndex::kVelocity);
  out.gyro_bias_rad_s += error.segment<3>(InertialIndex::kGyroBias);
  out.accel_bias_m_s2 += error.segment<3>(InertialIndex::kAccelBias);
  return out;
}

InertialError minus(const InertialState& to, const InertialState& from) {
  InertialError error;
  error << so3_log(from.world_from_imu.rotation.conjugate() * to.world_from_imu.rotation),
      to.world_from_imu.translation - from.world_from_imu.translation,
      to.velocity_in_world_m_s - from.velocity_in_world_m_s,
      to.gyro_bias_rad_s - from.gyro_bias_rad_s, to.accel_bias_m_s2 - from.accel_bias_m_s2;
  return error;
}

}  // namespace stillkite
