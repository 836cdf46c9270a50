#pragma once

#include <Eigen/Core>

#include "estimation/sliding_window/imu_preintegration.hpp"

namespace stillkite {

/// Residual of two successive states and an IMU preintegration, in standard deviations.
/// Order: rotation, velocity, position (Forster et al. 2017, eq. 45), gyro and accelerometer bias
/// (random walk).
struct ImuResidual {
  static constexpr int kSize = InertialIndex::kSize;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  Vector residual;
  Matrix by_start;  ///< d(residual)/d(error of the start), order of InertialIndex
  Matrix by_end;
};

/// Residual at (start, end); Jacobians at the linearization points.
[[nodiscard]] ImuResidual imu_residual(const ImuPreintegration& imu, const InertialState& start,
                                       const InertialState& end,
                                       const InertialState& start_linearization,
                                       const InertialState& end_linearization);

/// Squared length of the residual.
[[nodiscard]] double imu_squared_error(const ImuPreintegration& imu, const InertialState& start,
                                       const InertialState& end);

}  // namespace stillkite
