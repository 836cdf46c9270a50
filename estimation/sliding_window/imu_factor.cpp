#include "estimation/sliding_window/imu_factor.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

using Index = InertialIndex;

// Rows of the residual.
struct Row : ImuMotionIndex {
  static constexpr int kGyroBias = 9;
  static constexpr int kAccelBias = 12;
};

// Velocity and position change without gravity, in the start's axes.
struct Change {
  Eigen::Vector3d velocity;
  Eigen::Vector3d position;
};

Change measured_change(double dt, const InertialState& start, const InertialState& end) {
  const Eigen::Vector3d g = gravity_in_world();
  const Eigen::Quaterniond imu_from_world = start.world_from_imu.rotation.conjugate();
  return {imu_from_world * (end.velocity_in_world_m_s - start.velocity_in_world_m_s - dt * g),
          imu_from_world * (end.world_from_imu.translation - start.world_from_imu.translation -
                            dt * start.velocity_in_world_m_s - 0.5 * dt * dt * g)};
}

Eigen::Vector3d rotation_error(const ImuPreintegration::Motion& motion, const InertialState& start,
                               const InertialState& end) {
  return so3_log(motion.rotation.conjugate() * start.world_from_imu.rotation.conjugate() *
                 end.world_from_imu.rotation);
}

ImuResidual::Vector residual(const ImuPreintegration& imu, const InertialState& start,
                             const InertialState& end) {
  const ImuPreintegration::Motion motion = imu.motion(start.gyro_bias_rad_s, start.accel_bias_m_s2);
  const Change change = measured_change(imu.duration_s(), start, end);
  ImuResidual::Vector r;
  r << rotation_error(motion, start, end), change.velocity - motion.velocity,
      change.position - motion.position, end.gyro_bias_rad_s - start.gyro_bias_rad_s,
      end.accel_bias_m_s2 - start.accel_bias_m_s2;
  return r;
}

void add_jacobians(const ImuPreintegration& imu, const InertialState& start,
                   const InertialState& end, ImuResidual& out) {
  const double dt = imu.duration_s();
  const ImuPreintegration::Motion motion = imu.motion(start.gyro_bias_rad_s, start.accel_bias_m_s2);
  const Change change = measured_change(dt, start, end);
  const Eigen::Vector3d error = rotation_error(motion, start, end);
  const Eigen::Matrix3d inverse_right_jacobian = so3_left_jacobian(-error).inverse();
  const Eigen::Matrix3d imu_from_world =
      start.world_from_imu.rotation.conjugate().toRotationMatrix();
  const Eigen::Matrix3d end_from_start =
      (end.world_from_imu.rotation.conjugate() * start.world_from_imu.rotation).toRotationMatrix();
  const Eigen::Matrix<double, 9, 6>& by_bias = imu.bias_jacobian();
  const Eigen::Vector3d correction =
      by_bias.topLeftCorner<3, 3>() * (start.gyro_bias_rad_s - imu.gyro_bias_rad_s());

  ImuResidual::Matrix& by_start = out.by_start;
  by_start.setZero();
  by_start.block<3, 3>(Row::kRotation, Index::kRotation) = -inverse_right_jacobian * end_from_start;
  by_start.block<3, 3>(Row::kRotation, Index::kGyroBias) =
      -inverse_right_jacobian * so3_exp(-error).toRotationMatrix() *
      so3_left_jacobian(-correction) * by_bias.topLeftCorner<3, 3>();
  by_start.block<3, 3>(Row::kVelocity, Index::kRotation) = skew(change.velocity);
  by_start.block<3, 3>(Row::kVelocity, Index::kVelocity) = -imu_from_world;
  by_start.block<3, 6>(Row::kVelocity, Index::kGyroBias) = -by_bias.middleRows<3>(Row::kVelocity);
  by_start.block<3, 3>(Row::kPosition, Index::kRotation) = skew(change.position);
  by_start.block<3, 3>(Row::kPosition, Index::kPosition) = -imu_from_world;
  by_start.block<3, 3>(Row::kPosition, Index::kVelocity) = -dt * imu_from_world;
  by_start.block<3, 6>(Row::kPosition, Index::kGyroBias) = -by_bias.middleRows<3>(Row::kPosition);
  by_start.block<6, 6>(Row::kGyroBias, Index::kGyroBias).diagonal().setConstant(-1);

  ImuResidual::Matrix& by_end = out.by_end;
  by_end.setZero();
  by_end.block<3, 3>(Row::kRotation, Index::kRotation) = inverse_right_jacobian;
  by_end.block<3, 3>(Row::kVelocity, Index::kVelocity) = imu_from_world;
  by_end.block<3, 3>(Row::kPosition, Index::kPosition) = imu_from_world;
  by_end.block<6, 6>(Row::kGyroBias, Index::kGyroBias).diagonal().setConstant(1);
}

// Rows over their standard deviations.
class Whitening {
 public:
  explicit Whitening(const ImuPreintegration& imu)
      : factor_(imu.covariance()),
        gyro_walk_(std::max(kMinWalk, imu.noise().gyro_bias_walk) * std::sqrt(imu.duration_s())),
        accel_walk_(std::max(kMinWalk, imu.noise().accel_bias_walk) * std::sqrt(imu.duration_s())) {
  }

  template <typename Rows>
  void operator()(Rows& rows) const {
    auto top = rows.template topRows<9>();
    factor_.matrixL().solveInPlace(top);
    rows.template middleRows<3>(Row::kGyroBias) /= gyro_walk_;
    rows.template middleRows<3>(Row::kAccelBias) /= accel_walk_;
  }

 private:
  static constexpr double kMinWalk = 1e-9;
  Eigen::LLT<ImuPreintegration::Matrix9d> factor_;
  double gyro_walk_, accel_walk_;
};

}  // namespace

ImuResidual imu_residual(const ImuPreintegration& imu, const InertialState& start,
                         const InertialState& end, const InertialState& start_linearization,
                         const InertialState& end_linearization) {
  ImuResidual out;
  out.residual = residual(imu, start, end);
  add_jacobians(imu, start_linearization, end_linearization, out);
  const Whitening whiten(imu);
  whiten(out.residual);
  whiten(out.by_start);
  whiten(out.by_end);
  return out;
}

double imu_squared_error(const ImuPreintegration& imu, const InertialState& start,
                         const InertialState& end) {
  ImuResidual::Vector r = residual(imu, start, end);
  Whitening{imu}(r);
  return r.squaredNorm();
}

}  // namespace stillkite
