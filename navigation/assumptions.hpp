#pragma once

// What is assumed of every flight, in either mode.

namespace stillkite {

/// Variance of what is known exactly at the start, so that its covariance can be inverted.
inline constexpr double kExact = 1e-8;

/// At the start nothing is known of the speed: standard deviations in heights/s and rad/s.
inline constexpr double kAnySpeed_heights_s = 2.0;
inline constexpr double kAnyRate_rad_s = 2.0;

/// No frame leads further down than to this share of the height of what it is compared with.
inline constexpr double kLowest = 0.1;

}  // namespace stillkite
