#include "estimation/sliding_window/window_solver.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "estimation/robust_kernel.hpp"
#include "estimation/sliding_window/imu_factor.hpp"

namespace stillkite {
namespace {

constexpr int kPose = InertialIndex::kPoseSize;
constexpr int kExtrinsics = ExtrinsicsIndex::kSize;
constexpr RobustKernel kKernel = RobustKernel::huber;

// Huber's loss in the residual's squared length; 1/2 of it is the cost.
double robust_loss(double squared) {
  constexpr double kHuber = 1.5;  // as in robust_weight
  if (squared <= kHuber * kHuber) return squared;
  return 2 * kHuber * std::sqrt(squared) - kHuber * kHuber;
}

// A point's normal equations: V d = g - W^T (poses and extrinsics).
struct PointEquations {
  std::size_t track = 0;
  Eigen::Matrix3d V = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  struct PoseBlock {
    int at;
    Eigen::Matrix<double, 3, kPose> W;
  };
  std::vector<PoseBlock> poses;
  Eigen::Matrix<double, 3, kExtrinsics> by_extrinsics =
      Eigen::Matrix<double, 3, kExtrinsics>::Zero();
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  // of V, with damping

  Eigen::Matrix<double, 3, kPose>& pose_block(int at) {
    for (PoseBlock& block : poses) {
      if (block.at == at) return block.W;
    }
    poses.push_back({at, Eigen::Matrix<double, 3, kPose>::Zero()});
    return poses.back().W;
  }
};

// Normal equations before the elimination of the points; lower triangle only.
struct Linearization {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  std::vector<PointEquations> points;
};

ExtrinsicsError extrinsics_error(const Window& window) {
  return minus(window.extrinsics, window.first_extrinsics);
}

// Error of the present estimate from the prior's linearization point.
Eigen::VectorXd prior_error(const Window& window, const std::vector<int>& offsets) {
  Eigen::VectorXd error = Eigen::VectorXd::Zero(offsets.back());
  error.head<kExtrinsics>() = extrinsics_error(window);
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    const WindowFrame& frame = window.frames[i];
    if (!frame.first_estimate) continue;
    const InertialError d = minus(frame.state, *frame.first_estimate);
    error.segment(offsets[i], frame.size()) = d.head(frame.size());
  }
  return error;
}

void add_imu(const Window& window, std::size_t end, const std::vector<int>& offsets,
             Linearization& out) {
  const WindowFrame& from = window.frames[end - 1];
  const WindowFrame& to = window.frames[end];
  const ImuResidual imu =
      imu_residual(to.imu, from.state, to.state, from.linearization(), to.linearization());
  constexpr int kSize = InertialIndex::kSize;
  const int a = offsets[end - 1];
  const int b = offsets[end];
  out.H.block<kSize, kSize>(a, a).noalias() += imu.by_start.transpose() * imu.by_start;
  out.H.block<kSize, kSize>(b, b).noalias() += imu.by_end.transpose() * imu.by_end;
  out.H.block<kSize, kSize>(b, a).noalias() += imu.by_end.transpose() * imu.by_start;
  out.g.segment<kSize>(a).noalias() -= imu.by_start.transpose() * imu.residual;
  out.g.segment<kSize>(b).noalias() -= imu.by_end.transpose() * imu.residual;
}

void add_rest(const WindowFrame& frame, int offset, Linearization& out) {
  const double information = 1 / (*frame.rest_sigma_m_s * *frame.rest_sigma_m_s);
  const int at = offset + InertialIndex::kVelocity;
  out.H.diagonal().segment<3>(at).array() += information;
  out.g.segment<3>(at) -= information * frame.state.velocity_in_world_m_s;
}

void add_host_observation(const WindowTrack& track, PointEquations& point) {
  const WindowObservation& host = track.observations.front();
  const Eigen::Matrix2d information = host.covariance.inverse();
  point.V.topLeftCorner<2, 2>() += information;
  point.g.head<2>() += information * (host.bearing - track.point->bearing);
}

// Observation of a point by another camera than its first keyframe's; left out behind the camera.
void add_observation(const WindowFrame& host_frame, const WindowFrame& target_frame,
                     const WindowObservation& observation,
                     const std::optional<Eigen::Vector2d>& seen,
                     const std::optional<PointProjection>& linear, int h, int t,
                     PointEquations& point, Linearization& out) {
  if (!seen || !linear) return;
  const Eigen::Vector2d residual = observation.bearing - *seen;
  Eigen::Matrix2d information = observation.covariance.inverse();
  const double squared = residual.dot(information * residual);
  information *= robust_weight(kKernel, squared).weight;

  Eigen::Matrix<double, 2, kExtrinsics> by_extrinsics;
  by_extrinsics << linear->by_extrinsics,
      linear->by_host * host_frame.pose_rate() + linear->by_target * target_frame.pose_rate();
  const Eigen::Matrix<double, kPose, 2> host_weighted = linear->by_host.transpose() * information;
  const Eigen::Matrix<double, kPose, 2> target_weighted =
      linear->by_target.transpose() * information;
  const Eigen::Matrix<double, kExtrinsics, 2> extrinsics_weighted =
      by_extrinsics.transpose() * information;
  const Eigen::Matrix<double, 3, 2> point_weighted = linear->by_point.transpose() * information;
  out.H.block<kPose, kPose>(h, h).noalias() += host_weighted * linear->by_host;
  out.H.block<kPose, kPose>(t, t).noalias() += target_weighted * linear->by_target;
  if (h > t) {
    out.H.block<kPose, kPose>(h, t).noalias() += host_weighted * linear->by_target;
  } else {
    out.H.block<kPose, kPose>(t, h).noalias() += target_weighted * linear->by_host;
  }
  out.H.block<kExtrinsics, kExtrinsics>(0, 0).noalias() += extrinsics_weighted * by_extrinsics;
  out.H.block<kPose, kExtrinsics>(h, 0).noalias() += host_weighted * by_extrinsics;
  out.H.block<kPose, kExtrinsics>(t, 0).noalias() += target_weighted * by_extrinsics;
  out.g.segment<kPose>(h).noalias() += host_weighted * residual;
  out.g.segment<kPose>(t).noalias() += target_weighted * residual;
  out.g.head<kExtrinsics>().noalias() += extrinsics_weighted * residual;
  point.V.noalias() += point_weighted * linear->by_point;
  point.g.noalias() += point_weighted * residual;
  point.pose_block(h).noalias() += point_weighted * linear->by_host;
  point.pose_block(t).noalias() += point_weighted * linear->by_target;
  point.by_extrinsics.noalias() += point_weighted * by_extrinsics;
}

Linearization linearize(const Window& window, const WindowScope& scope) {
  const std::vector<int> offsets = window.offsets();
  const Eigen::Index size = offsets.back();
  Linearization out{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), {}};
  if (scope.prior) {
    out.H = window.prior.information;
    out.g = window.prior.gradient - window.prior.information * prior_error(window, offsets);
  }
  for (const std::size_t end : scope.imu_frames) add_imu(window, end, offsets, out);
  for (const std::size_t i : scope.rest_frames) add_rest(window.frames[i], offsets[i], out);
  CameraPairs present(window, false);
  CameraPairs first(window, true);
  out.points.reserve(scope.tracks.size());
  for (const std::size_t i : scope.tracks) {
    const WindowTrack& track = window.tracks[i];
    const std::size_t host = *window.find(track.observations.front().frame_id);
    PointEquations point;
    point.track = i;
    add_host_observation(track, point);
    for (std::size_t k = 1; k < track.observations.size(); ++k) {
      const WindowObservation& observation = track.observations[k];
      if (observation.frame_id == scope.excluded_frame_id) continue;
      const std::size_t target = *window.find(observation.frame_id);
      add_observation(window.frames[host], window.frames[target], observation,
                      project_bearing(present.at(host, target), *track.point),
                      project_point(first.at(host, target), *track.point), offsets[host],
                      offsets[target], point, out);
    }
    out.points.push_back(std::move(point));
  }
  return out;
}

// Subtracts W^T V^-1 W and W^T V^-1 g of each point; lower triangle only.
WindowEquations eliminate_points(Linearization& linear, double damping) {
  WindowEquations out{linear.H, linear.g};
  for (PointEquations& point : linear.points) {
    Eigen::Matrix3d V = point.V;
    V.diagonal() *= 1 + damping;
    point.inverse = V.inverse();
    if (!point.inverse.allFinite()) point.inverse.setZero();
    const Eigen::Vector3d inverse_g = point.inverse * point.g;
    const Eigen::Matrix<double, kExtrinsics, 3> extrinsics =
        point.by_extrinsics.transpose() * point.inverse;
    out.information.topLeftCorner<kExtrinsics, kExtrinsics>().noalias() -=
        extrinsics * point.by_extrinsics;
    out.gradient.head<kExtrinsics>().noalias() -= point.by_extrinsics.transpose() * inverse_g;
    for (const auto& a : point.poses) {
      const Eigen::Matrix<double, kPose, 3> weighted = a.W.transpose() * point.inverse;
      out.gradient.segment<kPose>(a.at).noalias() -= a.W.transpose() * inverse_g;
      out.information.block<kPose, kExtrinsics>(a.at, 0).noalias() -=
          weighted * point.by_extrinsics;
      for (const auto& b : point.poses) {
        if (b.at > a.at) continue;
        out.information.block<kPose, kPose>(a.at, b.at).noalias() -= weighted * b.W;
      }
    }
  }
  return out;
}

// Covariance of the newest frame's variables, which are the last: with H = L L^T, of L's last
// block.
Eigen::MatrixXd newest_covariance(const Window& window, const Eigen::LLT<Eigen::MatrixXd>& factor) {
  const Eigen::Index size = window.frames.back().size();
  const Eigen::MatrixXd root = factor.matrixLLT()
                                   .bottomRightCorner(size, size)
                                   .triangularView<Eigen::Lower>()
                                   .solve(Eigen::MatrixXd::Identity(size, size));
  return root.transpose() * root;
}

struct Cost {
  double total = 0;
  double reprojection = 0;
  int observations = 0;
};

Cost cost_of(const Window& window, const WindowScope& scope) {
  const std::vector<int> offsets = window.offsets();
  Cost cost;
  const Eigen::VectorXd d = prior_error(window, offsets);
  cost.total += 0.5 * d.dot(window.prior.information * d) - window.prior.gradient.dot(d);
  for (const std::size_t end : scope.imu_frames) {
    const WindowFrame& from = window.frames[end - 1];
    const WindowFrame& to = window.frames[end];
    cost.total += 0.5 * imu_squared_error(to.imu, from.state, to.state);
  }
  for (const std::size_t i : scope.rest_frames) {
    const WindowFrame& frame = window.frames[i];
    cost.total += 0.5 * (frame.state.velocity_in_world_m_s / *frame.rest_sigma_m_s).squaredNorm();
  }
  ReprojectionErrors errors(window);
  for (const std::size_t i : scope.tracks) {
    const WindowTrack& track = window.tracks[i];
    const WindowObservation& host = track.observations.front();
    const Eigen::Vector2d residual = host.bearing - track.point->bearing;
    cost.total += 0.5 * residual.dot(host.covariance.inverse() * residual);
    for (std::size_t k = 1; k < track.observations.size(); ++k) {
      const double squared = errors.squared(track, track.observations[k]);
      constexpr double kBehindCamera = 1e4;
      cost.reprojection += 0.5 * robust_loss(std::min(squared, kBehindCamera));
      ++cost.observations;
    }
  }
  cost.total += cost.reprojection;
  return cost;
}

// Values of all variables and points, to undo a step.
struct Values {
  CameraExtrinsics extrinsics;
  std::vector<InertialState> states;
  std::vector<InverseDepthPoint> points;
};

Values values_of(const Window& window, const WindowScope& scope) {
  Values values{window.extrinsics, {}, {}};
  values.states.reserve(window.frames.size());
  for (const WindowFrame& frame : window.frames) values.states.push_back(frame.state);
  values.points.reserve(scope.tracks.size());
  for (const std::size_t i : scope.tracks) values.points.push_back(*window.tracks[i].point);
  return values;
}

void restore(const Values& values, const WindowScope& scope, Window& window) {
  window.extrinsics = values.extrinsics;
  for (std::size_t i = 0; i < values.states.size(); ++i) {
    window.frames[i].state = values.states[i];
  }
  for (std::size_t i = 0; i < values.points.size(); ++i) {
    window.tracks[scope.tracks[i]].point = values.points[i];
  }
}

// A step that would move a point behind the camera or onto it is far outside the linear range.
constexpr double kMaxDepthRatio_per_step = 5;

void apply_step(const Eigen::VectorXd& step, const Linearization& linear, Window& window) {
  const std::vector<int> offsets = window.offsets();
  for (const PointEquations& point : linear.points) {
    Eigen::Vector3d right = point.g - point.by_extrinsics * step.head<kExtrinsics>();
    for (const auto& block : point.poses) right -= block.W * step.segment<kPose>(block.at);
    const Eigen::Vector3d d = point.inverse * right;
    InverseDepthPoint& target = *window.tracks[point.track].point;
    target.bearing += d.head<2>();
    target.inverse_depth =
        std::clamp(target.inverse_depth + d.z(), target.inverse_depth / kMaxDepthRatio_per_step,
                   target.inverse_depth * kMaxDepthRatio_per_step);
  }
  window.extrinsics = plus(window.extrinsics, step.head<kExtrinsics>());
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    WindowFrame& frame = window.frames[i];
    InertialError error = InertialError::Zero();
    error.head(frame.size()) = step.segment(offsets[i], frame.size());
    frame.state = plus(frame.state, error);
  }
}

}  // namespace

WindowScope whole_window(const Window& window) {
  WindowScope scope;
  for (std::size_t i = 0; i < window.tracks.size(); ++i) {
    if (window.tracks[i].point) scope.tracks.push_back(i);
  }
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    if (window.frames[i].has_motion && window.frames[i].rest_sigma_m_s) {
      scope.rest_frames.push_back(i);
    }
  }
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    const bool is_measured = !window.frames[i].imu.samples().empty();
    if (window.frames[i - 1].has_motion && is_measured) scope.imu_frames.push_back(i);
  }
  return scope;
}

WindowEquations window_equations(const Window& window, const WindowScope& scope) {
  Linearization linear = linearize(window, scope);
  WindowEquations equations = eliminate_points(linear, 0);
  equations.information.triangularView<Eigen::StrictlyUpper>() = equations.information.transpose();
  return equations;
}

const CameraPair& CameraPairs::at(std::size_t host, std::size_t target) {
  std::optional<CameraPair>& pair = pairs_[host * window_.frames.size() + target];
  if (!pair) {
    const double shift_s = window_.image_shift_s();
    const CameraExtrinsics& extrinsics =
        at_first_estimates_ ? window_.first_extrinsics : window_.extrinsics;
    pair = camera_pair(window_.frames[host].world_from_imu_after(shift_s, at_first_estimates_),
                       window_.frames[target].world_from_imu_after(shift_s, at_first_estimates_),
                       extrinsics.imu_from_camera);
  }
  return *pair;
}

double ReprojectionErrors::squared(const WindowTrack& track, const WindowObservation& observation) {
  const std::size_t host = *window_.find(track.observations.front().frame_id);
  const std::size_t target = *window_.find(observation.frame_id);
  const auto seen = project_bearing(pairs_.at(host, target), *track.point);
  if (!seen) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d residual = observation.bearing - *seen;
  return residual.dot(observation.covariance.inverse() * residual);
}

WindowFit optimize(Window& window, int max_iterations) {
  constexpr double kMinDecrease = 0.02;  // by a step of 0.2 standard deviations
  constexpr double kMinDamping = 1e-6;
  constexpr double kMaxDamping = 1e3;
  const WindowScope scope = whole_window(window);
  Cost cost = cost_of(window, scope);
  double damping = 0;  // Gauss-Newton, unless the cost grows
  WindowFit fit;
  Linearization linear = linearize(window, scope);
  while (fit.iterations < max_iterations && damping < kMaxDamping) {
    ++fit.iterations;
    WindowEquations equations = eliminate_points(linear, damping);
    equations.information.diagonal() *= 1 + damping;
    const Eigen::LLT<Eigen::MatrixXd> factor(equations.information);
    const Eigen::VectorXd step = factor.solve(equations.gradient);
    const bool is_solved = factor.info() == Eigen::Success && step.allFinite();
    const Values before = values_of(window, scope);
    if (is_solved) apply_step(step, linear, window);
    const Cost next = cost_of(window, scope);
    if (!is_solved || !(next.total <= cost.total)) {
      restore(before, scope, window);
      damping = std::max(kMinDamping, 10 * damping);
      continue;
    }
    if (damping == 0) fit.newest_covariance = newest_covariance(window, factor);
    const double decrease = cost.total - next.total;
    cost = next;
    damping = damping > kMinDamping ? 0.1 * damping : 0;
    if (decrease < kMinDecrease) break;
    linear = linearize(window, scope);
  }
  fit.cost = cost.total;
  fit.reprojection = cost.reprojection;
  fit.observations = cost.observations;
  return fit;
}

double newton_decrement(const Window& window) {
  const WindowEquations equations = window_equations(window, whole_window(window));
  const Eigen::LLT<Eigen::MatrixXd> factor(equations.information);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  return 0.5 * equations.gradient.dot(factor.solve(equations.gradient));
}

std::optional<Eigen::MatrixXd> window_covariance(const Window& window) {
  const WindowEquations equations = window_equations(window, whole_window(window));
  const Eigen::LLT<Eigen::MatrixXd> factor(equations.information);
  if (factor.info() != Eigen::Success) return std::nullopt;
  return factor.solve(
      Eigen::MatrixXd::Identity(equations.gradient.size(), equations.gradient.size()));
}

}  // namespace stillkite
