#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <utility>

#include "estimation/twist.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// One velocity, linear or angular, and the variance of its error.
struct AxisEstimate {
  double value = 0;
  double variance = 0;
};

/// Equation (3) of the flow paper: V <- V + a dt, P <- P + Q. Alone it is the step of a frame
/// without an answer.
[[nodiscard]] AxisEstimate predict_axis(const AxisEstimate& previous, double acceleration,
                                        double dt_s, double process_variance);

/// Equations (5) and (6), R > 0: K = P / (P + R), V <- K m + (1 - K) V, P <- R P / (P + R).
[[nodiscard]] AxisEstimate correct_axis(const AxisEstimate& predicted, double measurement,
                                        double measurement_variance);

/// Where (5) and (6) settle: P = (-Q + sqrt(Q^2 + 4 Q R)) / 2, K = P / R.
struct AxisSteadyState {
  double variance;
  double gain;
};
[[nodiscard]] AxisSteadyState axis_steady_state(double process_variance,
                                                double measurement_variance);

/// Whose variance a measurement gets: the config's (the paper's) or its own.
enum class MeasurementVariance { fixed, measured };

template <>
struct EnumNames<MeasurementVariance> {
  static constexpr auto value = std::to_array<std::pair<MeasurementVariance, std::string_view>>(
      {{MeasurementVariance::fixed, "fixed"}, {MeasurementVariance::measured, "measured"}});
};

/// Six filters side by side, the defaults those of the flow paper's section 5.1. The process noise
/// is, as there, that of one step.
struct KalmanFilterConfig {
  MeasurementVariance variance = MeasurementVariance::fixed;
  double velocity_sigma_m_s = 0.3;
  double angular_rate_sigma_rad_s = 0.00015;
  double velocity_process_sigma_m_s = 0.1;
  double angular_rate_process_sigma_rad_s = 0.017;

  static void fields(auto& self, auto&& field) {
    field("variance", self.variance,
          "whose variance a measurement gets: the fixed ones below, its own");
    field("velocity_sigma_m_s", self.velocity_sigma_m_s, Range{1e-9, 1e9},
          "of a measurement, an axis");
    field("angular_rate_sigma_rad_s", self.angular_rate_sigma_rad_s, Range{1e-9, 1e9},
          "of a measurement, an axis");
    field("velocity_process_sigma_m_s", self.velocity_process_sigma_m_s, Range{0, 1e9},
          "change of velocity in one step, an axis");
    field("angular_rate_process_sigma_rad_s", self.angular_rate_process_sigma_rad_s, Range{0, 1e9},
          "change of angular rate in one step, an axis");
  }
};

/// The paper's vector V = (V_x, V_y, V_z, w_x, w_y, w_z): velocity in the world's axes, angular
/// rate in the camera's.
using AxisEstimates = std::array<AxisEstimate, 6>;

/// One frame's least squares in those axes.
struct AxisMeasurement {
  Vector6d value;
  Vector6d variance;  ///< diagonal of the covariance in those axes
};
[[nodiscard]] AxisMeasurement in_filter_axes(const Twist& twist_in_camera,
                                             const Matrix6d& covariance,
                                             const Eigen::Quaterniond& world_from_camera);

/// Step 4 of the flow paper's procedure, one frame: predicts with the acceleration function a(t)
/// and corrects with the measurement, if this frame has one.
[[nodiscard]] AxisEstimates filter_axes(const KalmanFilterConfig& config,
                                        const AxisEstimates& previous,
                                        const std::optional<AxisMeasurement>& measurement,
                                        const Vector6d& acceleration, double dt_s);

}  // namespace stillkite
