#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "estimation/ego_motion/kalman_filter_config.hpp"
#include "estimation/twist.hpp"

namespace stillkite {

/// Estimate of one velocity component (m/s or rad/s) and its error variance.
struct AxisEstimate {
  double value = 0;
  double variance = 0;
};

/// Prediction: V <- V + a dt, P <- P + Q (flow paper, eq. 3). The only step of a frame without a
/// measurement.
[[nodiscard]] AxisEstimate predict_axis(const AxisEstimate& previous, double acceleration,
                                        double dt_s, double process_variance);

/// Correction: K = P / (P + R), V <- K m + (1 - K) V, P <- R P / (P + R) (flow paper, eq. 5 and 6).
/// Precondition: R > 0.
[[nodiscard]] AxisEstimate correct_axis(const AxisEstimate& predicted, double measurement,
                                        double measurement_variance);

/// Steady state of the filter: P = (-Q + sqrt(Q^2 + 4 Q R)) / 2, K = P / R.
struct AxisSteadyState {
  double variance;
  double gain;
};
[[nodiscard]] AxisSteadyState axis_steady_state(double process_variance,
                                                double measurement_variance);

/// State V = (V_x, V_y, V_z, w_x, w_y, w_z): velocity in world, angular rate in camera.
using AxisEstimates = std::array<AxisEstimate, 6>;

/// Twist measurement in the axes of the filter.
struct AxisMeasurement {
  Vector6d value;
  Vector6d variance;  ///< diagonal of the covariance
};

/// Converts a twist and its covariance, both in camera, to the axes of the filter.
[[nodiscard]] AxisMeasurement in_filter_axes(const Twist& twist_in_camera,
                                             const Matrix6d& covariance,
                                             const Eigen::Quaterniond& world_from_camera);

/// Filter step of one frame (flow paper, step 4): prediction with the acceleration a(t), correction
/// if there is a measurement.
[[nodiscard]] AxisEstimates filter_axes(const KalmanFilterConfig& config,
                                        const AxisEstimates& previous,
                                        const std::optional<AxisMeasurement>& measurement,
                                        const Vector6d& acceleration, double dt_s);

}  // namespace stillkite
