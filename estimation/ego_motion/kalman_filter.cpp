#include "estimation/ego_motion/kalman_filter.hpp"

#include <cmath>

namespace stillkite {

AxisEstimate predict_axis(const AxisEstimate& previous, double acceleration, double dt_s,
                          double process_variance) {
  return {previous.value + acceleration * dt_s, previous.variance + process_variance};
}

AxisEstimate correct_axis(const AxisEstimate& predicted, double measurement,
                          double measurement_variance) {
  const double K = predicted.variance / (predicted.variance + measurement_variance);
  return {K * measurement + (1 - K) * predicted.value, K * measurement_variance};
}

AxisSteadyState axis_steady_state(double process_variance, double measurement_variance) {
  const double Q = process_variance;
  const double R = measurement_variance;
  const double P = 0.5 * (-Q + std::sqrt(Q * Q + 4 * Q * R));
  return {P, P / R};
}

AxisMeasurement in_filter_axes(const Twist& twist_in_camera, const Matrix6d& covariance,
                               const Eigen::Quaterniond& world_from_camera) {
  const Eigen::Matrix3d R = world_from_camera.toRotationMatrix();
  AxisMeasurement out{twist_in_camera.vector(), covariance.diagonal()};
  out.value.head<3>() = R * twist_in_camera.velocity_m_s;
  out.variance.head<3>() = (R * covariance.topLeftCorner<3, 3>() * R.transpose()).diagonal();
  return out;
}

AxisEstimates filter_axes(const KalmanFilterConfig& config, const AxisEstimates& previous,
                          const std::optional<AxisMeasurement>& measurement,
                          const Vector6d& acceleration, double dt_s) {
  AxisEstimates out;
  for (int axis = 0; axis < 6; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const bool linear = axis < 3;
    const double process_sigma =
        linear ? config.velocity_process_sigma_m_s : config.angular_rate_process_sigma_rad_s;
    out[i] = predict_axis(previous[i], acceleration(axis), dt_s, process_sigma * process_sigma);
    if (!measurement) continue;
    const double fixed_sigma = linear ? config.velocity_sigma_m_s : config.angular_rate_sigma_rad_s;
    const double variance = config.variance == MeasurementVariance::fixed
                                ? fixed_sigma * fixed_sigma
                                : measurement->variance(axis);
    out[i] = correct_axis(out[i], measurement->value(axis), variance);
  }
  return out;
}

}  // namespace stillkite
