#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <utility>

#include "estimation/twist.hpp"
#include "geometry/fields.hpp"

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

/// Measurement variance: configured (flow paper) or estimated by the least squares.
enum class MeasurementVariance { fixed, measured };

template <>
struct EnumNames<MeasurementVariance> {
  static constexpr auto value = std::to_array<std::pair<MeasurementVariance, std::string_view>>(
      {{MeasurementVariance::fixed, "fixed"}, {MeasurementVariance::measured, "measured"}});
};

/// Six scalar Kalman filters, one per velocity component. Defaults: flow paper, section 5.1;
/// process noise per step.
struct KalmanFilterConfig {
  MeasurementVariance variance = MeasurementVariance::fixed;
  double velocity_sigma_m_s = 0.3;
  double angular_rate_sigma_rad_s = 0.00015;
  double velocity_process_sigma_m_s = 0.1;
  double angular_rate_process_sigma_rad_s = 0.017;

  static void fields(auto& self, auto&& field) {
    field("variance", self.variance,
          "measurement variance: configured below, or estimated per frame");
    field("velocity_sigma_m_s", self.velocity_sigma_m_s, Range{1e-9, 1e9},
          "standard deviation of a velocity measurement, per axis");
    field("angular_rate_sigma_rad_s", self.angular_rate_sigma_rad_s, Range{1e-9, 1e9},
          "standard deviation of an angular rate measurement, per axis");
    field("velocity_process_sigma_m_s", self.velocity_process_sigma_m_s, Range{0, 1e9},
          "standard deviation of the velocity change per step, per axis");
    field("angular_rate_process_sigma_rad_s", self.angular_rate_process_sigma_rad_s, Range{0, 1e9},
          "standard deviation of the angular rate change per step, per axis");
  }
};

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
