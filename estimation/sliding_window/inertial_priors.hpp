#pragma once

namespace stillkite {

/// Standard deviations, per axis, of the variables before any measurement: a MEMS device, and a
/// camera whose clock, mount and lever arm are known roughly.
struct InertialPriors {
  double gyro_bias_rad_s = 0.1;
  double accel_bias_m_s2 = 0.2;
  double camera_rotation_rad = 0.02;
  double lever_arm_m = 0.05;
  double time_offset_s = 0.03;
};

/// Squared deviation of three variables, in variances, beyond which they contradict their prior:
/// the quantile of the probability of 5 sigma, three degrees of freedom.
inline constexpr double kFiveSigma3 = 31.8;

}  // namespace stillkite
