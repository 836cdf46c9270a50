#include "estimation/sliding_window/window_equations.hpp"

#include <Eigen/LU>
#include <optional>
#include <utility>

#include "estimation/robust_kernel.hpp"
#include "estimation/sliding_window/imu_factor.hpp"
#include "estimation/sliding_window/reprojection_errors.hpp"

namespace stillkite {
namespace {

constexpr int kPose = InertialIndex::kPoseSize;
constexpr int kExtrinsics = ExtrinsicsIndex::kSize;

void add_imu(const Window& window, std::size_t end, const std::vector<int>& offsets,
             WindowLinearization& out) {
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

void add_rest(const WindowFrame& frame, int offset, WindowLinearization& out) {
  const double information = 1 / (*frame.rest_sigma_m_s * *frame.rest_sigma_m_s);
  const int at = offset + InertialIndex::kVelocity;
  out.H.diagonal().segment<3>(at).array() += information;
  out.g.segment<3>(at) -= information * frame.state.velocity_in_world_m_s;
}

void add_host_observation(const WindowTrack& track, PointEquations& point) {
  const WindowObservation& host = track.observations.front();
  point.V.topLeftCorner<2, 2>() += host.information;
  point.g.head<2>() += host.information * (host.bearing - track.point->bearing);
}

// Observation of a point by another camera than its first keyframe's; left out behind the camera.
void add_observation(const WindowFrame& host_frame, const WindowFrame& target_frame,
                     const WindowObservation& observation,
                     const std::optional<Eigen::Vector2d>& seen,
                     const std::optional<PointProjection>& linear, int h, int t,
                     PointEquations& point, WindowLinearization& out) {
  if (!seen || !linear) return;
  const Eigen::Vector2d residual = observation.bearing - *seen;
  const double squared = residual.dot(observation.information * residual);
  const Eigen::Matrix2d information =
      robust_weight(RobustKernel::huber, squared).weight * observation.information;

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

Eigen::VectorXd error_from_first_estimates(const Window& window) {
  const std::vector<int> offsets = window.offsets();
  Eigen::VectorXd error = Eigen::VectorXd::Zero(offsets.back());
  error.head<kExtrinsics>() = minus(window.extrinsics, window.first_extrinsics);
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    const WindowFrame& frame = window.frames[i];
    if (!frame.first_estimate) continue;
    const InertialError d = minus(frame.state, *frame.first_estimate);
    error.segment(offsets[i], frame.size()) = d.head(frame.size());
  }
  return error;
}

WindowLinearization linearize(const Window& window, const WindowScope& scope) {
  const std::vector<int> offsets = window.offsets();
  WindowLinearization out;
  out.H = window.prior.information;
  out.g = window.prior.gradient - window.prior.information * error_from_first_estimates(window);
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

// Subtracts W^T V^-1 W and W^T V^-1 g of each point.
WindowEquations eliminate_points(WindowLinearization& linear, double damping) {
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

WindowEquations window_equations(const Window& window, const WindowScope& scope) {
  WindowLinearization linear = linearize(window, scope);
  WindowEquations equations = eliminate_points(linear, 0);
  equations.information.triangularView<Eigen::StrictlyUpper>() = equations.information.transpose();
  return equations;
}

}  // namespace stillkite
