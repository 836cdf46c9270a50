#include "estimation/sliding_window/rotation_alignment.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>
#include <vector>

#include "estimation/sliding_window/epipolar_rotation.hpp"

namespace stillkite {
namespace {

// Two frames with the bearings of the points in both.
struct RotatedPair {
  std::size_t first, second;
  std::vector<BearingMatch> matches;
};

std::vector<RotatedPair> rotated_pairs(const Window& window) {
  constexpr std::size_t kStrides[] = {1, 3};
  constexpr std::size_t kMinMatches = 12;
  std::vector<RotatedPair> pairs;
  for (const std::size_t stride : kStrides) {
    for (std::size_t end = stride; end < window.frames.size(); ++end) {
      RotatedPair pair{end - stride, end, {}};
      for (const WindowTrack& track : window.tracks) {
        const WindowObservation* first = track.in(window.frames[pair.first].id);
        const WindowObservation* second = track.in(window.frames[pair.second].id);
        if (first == nullptr || second == nullptr) continue;
        pair.matches.push_back({first->bearing.homogeneous(), second->bearing.homogeneous(),
                                0.5 * (first->variance() + second->variance())});
      }
      if (pair.matches.size() >= kMinMatches) pairs.push_back(std::move(pair));
    }
  }
  return pairs;
}

// Variables: gyroscope bias, clock offset.
using Vector4d = Eigen::Matrix<double, 4, 1>;
struct AlignmentEquations {
  Eigen::Matrix4d H = Eigen::Matrix4d::Zero();
  Vector4d g = Vector4d::Zero();
};

// Rotation of the gyroscope (first IMU from second) with the Jacobian of its error in the second
// IMU's axes.
struct GyroRotation {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 3, 4> jacobian = Eigen::Matrix<double, 3, 4>::Zero();
};

GyroRotation gyro_rotation(const Window& window, const RotatedPair& pair) {
  GyroRotation out;
  auto by_bias = out.jacobian.leftCols<3>();
  for (std::size_t i = pair.first + 1; i <= pair.second; ++i) {
    const WindowFrame& frame = window.frames[i];
    const Eigen::Matrix3d step =
        frame.imu.motion(frame.state.gyro_bias_rad_s, frame.state.accel_bias_m_s2)
            .rotation.toRotationMatrix();
    out.rotation *= step;
    by_bias = step.transpose() * by_bias + frame.imu.bias_jacobian().topLeftCorner<3, 3>();
  }
  const auto rate = [&](std::size_t i) -> Eigen::Vector3d {
    return window.frames[i].gyro_rad_s - window.frames[i].state.gyro_bias_rad_s;
  };
  out.jacobian.col(3) = rate(pair.second) - out.rotation.transpose() * rate(pair.first);
  return out;
}

// With the error of the second camera's axes.
void add_pair(const RotatedPair& pair, const GyroRotation& gyro,
              const Eigen::Quaterniond& imu_from_camera, bool is_robust, AlignmentEquations& out) {
  const Eigen::Matrix3d R_e = imu_from_camera.toRotationMatrix();
  const RotationEquations equations =
      epipolar_equations(pair.matches, R_e.transpose() * gyro.rotation * R_e, is_robust);
  const Eigen::Matrix<double, 3, 4> jacobian = R_e.transpose() * gyro.jacobian;
  out.H += jacobian.transpose() * equations.H * jacobian;
  out.g += jacobian.transpose() * equations.g;
}

}  // namespace

bool align_rotations(Window& window, const InertialPriors& priors) {
  constexpr std::size_t kMinPairs = 3;
  constexpr int kLeastSquares = 3;  // iterations before the robust ones
  constexpr int kMaxIterations = 10;
  constexpr double kMinStep_rad_s = 1e-5;
  constexpr double kMinStep_s = 1e-5;
  const std::vector<RotatedPair> pairs = rotated_pairs(window);
  if (pairs.size() < kMinPairs) return false;
  Vector4d sigmas;
  sigmas << Eigen::Vector3d::Constant(priors.gyro_bias_rad_s), priors.time_offset_s;
  Vector4d value;
  value << Eigen::Vector3d::Zero(), window.calibrated.time_offset_s;
  const Vector4d expected = value;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    window.extrinsics.time_offset_s = value(3);
    for (WindowFrame& frame : window.frames) {
      frame.state.gyro_bias_rad_s = value.head<3>();
      frame.state.accel_bias_m_s2.setZero();
    }
    linearize_at_present(window);
    AlignmentEquations equations;
    equations.H.diagonal() = sigmas.cwiseAbs2().cwiseInverse();
    equations.g = equations.H * (expected - value);
    for (const RotatedPair& pair : pairs) {
      add_pair(pair, gyro_rotation(window, pair), window.extrinsics.imu_from_camera.rotation,
               iteration >= kLeastSquares, equations);
    }
    const Vector4d step = equations.H.ldlt().solve(equations.g);
    if (!step.allFinite()) return false;
    const bool is_converged =
        step.head<3>().norm() < kMinStep_rad_s && std::abs(step(3)) < kMinStep_s;
    if (is_converged && iteration >= kLeastSquares) break;
    value += step;
  }
  return true;
}

}  // namespace stillkite
