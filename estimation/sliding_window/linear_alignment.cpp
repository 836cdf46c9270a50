#include "estimation/sliding_window/linear_alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "estimation/robust_kernel.hpp"
#include "geometry/gravity.hpp"

namespace stillkite {
namespace {

// Poses of the IMU in the first frame's axes without velocity and gravity.
struct Integrated {
  double t_s = 0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

std::vector<Integrated> integrate(const Window& window) {
  std::vector<Integrated> out(1);
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    const ImuPreintegration& imu = window.frames[i].imu;
    const InertialState& state = window.frames[i].state;
    const auto motion = imu.motion(state.gyro_bias_rad_s, state.accel_bias_m_s2);
    const Integrated& from = out.back();
    const double dt = imu.duration_s();
    out.push_back({from.t_s + dt, (from.rotation * motion.rotation).normalized(),
                   from.velocity + from.rotation * motion.velocity,
                   from.position + dt * from.velocity + from.rotation * motion.position});
  }
  return out;
}

using Matrix66 = Eigen::Matrix<double, 6, 6>;

// Equations of one track in (velocity, gravity) and its depth.
struct TrackEquations {
  Matrix66 H = Matrix66::Zero();
  Vector6d g = Vector6d::Zero();
  Vector6d by_depth = Vector6d::Zero();
  double depth_information = 0;
  double depth_gradient = 0;
};

TrackEquations track_equations(const Window& window, const WindowTrack& track,
                               const std::vector<Integrated>& frames,
                               const std::optional<double>& depth_m, const Vector6d& solution) {
  const RigidTransform& imu_from_camera = window.extrinsics.imu_from_camera;
  TrackEquations out;
  const Integrated& host = frames[*window.find(track.observations.front().frame_id)];
  const Eigen::Vector3d along =
      host.rotation * (imu_from_camera.rotation * track.observations.front().bearing.homogeneous());
  const Eigen::Vector3d host_camera = host.position + host.rotation * imu_from_camera.translation;
  for (std::size_t i = 1; i < track.observations.size(); ++i) {
    const WindowObservation& observation = track.observations[i];
    const Integrated& frame = frames[*window.find(observation.frame_id)];
    Eigen::Matrix<double, 2, 3> line;
    line << 1, 0, -observation.bearing.x(), 0, 1, -observation.bearing.y();
    const Eigen::Matrix3d camera_from_first =
        (frame.rotation * imu_from_camera.rotation).conjugate().toRotationMatrix();
    line = line * camera_from_first;
    const Eigen::Vector3d known =
        host_camera - frame.position - frame.rotation * imu_from_camera.translation;
    Eigen::Matrix<double, 2, 6> A;
    A << (host.t_s - frame.t_s) * line, 0.5 * (host.t_s * host.t_s - frame.t_s * frame.t_s) * line;
    const Eigen::Vector2d by_depth = line * along;
    const Eigen::Vector2d constant = line * known;
    double weight = 1 / observation.variance();
    if (depth_m) {
      // residuals on z = 1: over the point's depth in this camera
      Eigen::Matrix<double, 3, 6> shift;
      shift << (host.t_s - frame.t_s) * Eigen::Matrix3d::Identity(),
          0.5 * (host.t_s * host.t_s - frame.t_s * frame.t_s) * Eigen::Matrix3d::Identity();
      const double z = (camera_from_first * (known + shift * solution + *depth_m * along)).z();
      constexpr double kMinDepth_m = 0.05;
      if (!(z > kMinDepth_m)) continue;
      weight /= z * z;
      const double squared = weight * (A * solution + by_depth * *depth_m + constant).squaredNorm();
      weight *= robust_weight(RobustKernel::huber, squared).weight;
    }
    out.H += weight * A.transpose() * A;
    out.g -= weight * A.transpose() * constant;
    out.by_depth += weight * A.transpose() * by_depth;
    out.depth_information += weight * by_depth.squaredNorm();
    out.depth_gradient -= weight * by_depth.dot(constant);
  }
  return out;
}

// (velocity, gravity) with gravity's known length: minimum of x^T H x - 2 g^T x on the sphere.
std::optional<Vector6d> solve_on_sphere(const Matrix66& H, const Vector6d& g) {
  const Eigen::LDLT<Eigen::Matrix3d> velocity(H.topLeftCorner<3, 3>());
  const Eigen::Matrix3d cross = H.topRightCorner<3, 3>();
  const Eigen::Matrix3d reduced =
      H.bottomRightCorner<3, 3>() - cross.transpose() * velocity.solve(cross);
  const Eigen::Vector3d right = g.tail<3>() - cross.transpose() * velocity.solve(g.head<3>());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(reduced);
  const Eigen::Vector3d in_axes = eigen.eigenvectors().transpose() * right;
  const Eigen::Vector3d& values = eigen.eigenvalues();
  if (!(values(2) > 0) || !in_axes.allFinite()) return std::nullopt;
  const auto length = [&](double multiplier) {
    return (in_axes.array() / (values.array() + multiplier)).matrix().norm();
  };
  double low = -values(0) * (1 - 1e-12);
  double high = low + in_axes.norm() / kGravity_m_s2 + values(2);
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (length(middle) > kGravity_m_s2 ? low : high) = middle;
  }
  const double multiplier = 0.5 * (low + high);
  Vector6d x;
  x.tail<3>() = eigen.eigenvectors() * (in_axes.array() / (values.array() + multiplier)).matrix();
  x.head<3>() = velocity.solve(g.head<3>() - cross * x.tail<3>());
  if (!x.allFinite()) return std::nullopt;
  x.tail<3>() *= kGravity_m_s2 / x.tail<3>().norm();
  return x;
}

}  // namespace

std::optional<LinearAlignment> align_linearly(const Window& window) {
  constexpr int kIterations = 4;  // with the weights of the depths before
  const std::vector<Integrated> frames = integrate(window);
  LinearAlignment out;
  out.depths_m.resize(window.tracks.size());
  Vector6d solution = Vector6d::Zero();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::vector<TrackEquations> equations(window.tracks.size());
    Matrix66 H = Matrix66::Zero();
    Vector6d g = Vector6d::Zero();
    for (std::size_t i = 0; i < window.tracks.size(); ++i) {
      const WindowTrack& track = window.tracks[i];
      if (track.observations.size() < 3) continue;
      if (iteration > 0 && !(out.depths_m[i].value_or(-1) > 0)) continue;
      TrackEquations& of = equations[i];
      of = track_equations(window, track, frames, out.depths_m[i], solution);
      if (!(of.depth_information > 0)) continue;
      H += of.H - of.by_depth * of.by_depth.transpose() / of.depth_information;
      g += of.g - of.by_depth * of.depth_gradient / of.depth_information;
    }
    const std::optional<Vector6d> solved = solve_on_sphere(H, g);
    if (!solved) return std::nullopt;
    solution = *solved;
    for (std::size_t i = 0; i < equations.size(); ++i) {
      const TrackEquations& of = equations[i];
      if (!(of.depth_information > 0)) continue;
      out.depths_m[i] = (of.depth_gradient - of.by_depth.dot(solution)) / of.depth_information;
    }
  }
  out.velocity = solution.head<3>();
  out.gravity = solution.tail<3>();
  for (const Integrated& frame : frames) {
    const Eigen::Vector3d position =
        frame.position + frame.t_s * out.velocity + 0.5 * frame.t_s * frame.t_s * out.gravity;
    out.first_from_imu.push_back({frame.rotation, position});
    out.velocities.push_back(out.velocity + frame.t_s * out.gravity + frame.velocity);
  }
  return out;
}

}  // namespace stillkite
