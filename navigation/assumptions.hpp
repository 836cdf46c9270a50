#pragma once

// Initial uncertainties and limits shared by all estimators.

namespace stillkite {

/// Variance of exactly given initial values; positive, so that the covariance is invertible.
inline constexpr double kExactVariance = 1e-8;

/// Standard deviations of the unknown initial velocity, heights/s, and angular rate, rad/s.
inline constexpr double kInitialSpeedSigma_heights_s = 2.0;
inline constexpr double kInitialRateSigma_rad_s = 2.0;

/// Minimum height of a frame, as a ratio of the height of the frame it is aligned to.
inline constexpr double kMinHeightRatio = 0.1;

}  // namespace stillkite
