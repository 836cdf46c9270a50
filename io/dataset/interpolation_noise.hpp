#pragma once

#include <Eigen/Core>

#include "io/dataset/sensor_log.hpp"

// Motion between two readings of an IMU or gyroscope of a low rate is not measured. Model: between
// readings at the interval T the signal is a Wiener process of the spectral density S, estimated by
// the readings: their second differences have the variance 2 S T. The error of the linear
// interpolation is a Brownian bridge; its mean variance is S T / 6, its integral over T has the
// variance S T^3 / 12.

namespace stillkite {

/// Logs with a lower rate have a noise of the interpolation, and are reported.
inline constexpr double kMinImuRate_hz = 50;

struct InterpolationNoise {
  double sigma = 0;    ///< of a value between two readings, per axis
  double density = 0;  ///< of white noise with the same integral over T, per axis
};

/// Zero for logs of 50 readings per second or more. `density`: of the readings' own white noise,
/// whose part in the second differences is 6 density^2 / T.
[[nodiscard]] InterpolationNoise interpolation_noise(const TimeSeries<Eigen::Vector3d>& readings,
                                                     double density);

}  // namespace stillkite
