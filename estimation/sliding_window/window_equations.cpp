#include "estimation/sliding_window/window_equations.hpp"

#include <Eigen/LU>
#include <numeric>
#include <optional>
#include <span>

#include "estimation/robust_kernel.hpp"
#include "estimation/sliding_window/ground_equations.hpp"
#include "estimation/sliding_window/imu_factor.hpp"
#include "estimation/sliding_window/reprojection_errors.hpp"

namespace stillkite {
namespace {

constexpr int kPose = InertialIndex::kPoseSize;
constexpr int kCommon = SharedIndex::kSize;

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

// Index of the equations of each host, and of each pair among those of its host.
class EquationsIndex {
 public:
  explicit EquationsIndex(std::size_t frames)
      : frames_(frames), hosts_(frames), pairs_(frames * frames) {}

  std::optional<std::size_t>& host(std::size_t host) { return hosts_[host]; }
  std::optional<std::size_t>& pair(std::size_t host, std::size_t target) {
    return pairs_[host * frames_ + target];
  }

 private:
  std::size_t frames_;
  std::vector<std::optional<std::size_t>> hosts_;
  std::vector<std::optional<std::size_t>> pairs_;
};

// A view of a point; left out behind the camera.
void add_view(const WindowObservation& observation, const std::optional<Eigen::Vector2d>& seen,
              const std::optional<PointProjection>& linear, std::size_t pair, PointEquations& point,
              HostEquations& out) {
  if (!seen || !linear) return;
  const Eigen::Vector2d residual = observation.bearing - *seen;
  const double squared = residual.dot(observation.information * residual);
  const Eigen::Matrix2d information =
      robust_weight(RobustKernel::huber, squared).weight * observation.information;
  const Eigen::Matrix<double, 6, 2> pair_weighted = linear->by_pair.transpose() * information;
  const Eigen::Matrix<double, 3, 2> point_weighted = linear->by_point.transpose() * information;
  PairEquations& equations = out.pairs[pair];
  equations.H.noalias() += pair_weighted * linear->by_pair;
  equations.g.noalias() += pair_weighted * residual;
  point.V.noalias() += point_weighted * linear->by_point;
  point.g.noalias() += point_weighted * residual;
  out.views.push_back({pair, point_weighted * linear->by_pair});
}

// The height above the ground is zero.
void add_ground(const WindowTrack& track, const GroundView& present, const GroundView& linear,
                std::size_t pair, PointEquations& point, HostEquations& out) {
  const double information = track.ground_information;
  const double residual = -present.height_ratio(*track.point);
  Vector6d by_pair = Vector6d::Zero();
  by_pair.head<4>() << track.point->bearing, 1, track.point->inverse_depth;
  const Eigen::Vector3d by_point(linear.normal.x(), linear.normal.y(), linear.height_m);
  PairEquations& equations = out.pairs[pair];
  equations.H.noalias() += information * by_pair * by_pair.transpose();
  equations.g += information * residual * by_pair;
  point.V.noalias() += information * by_point * by_point.transpose();
  point.g += information * residual * by_point;
  out.views.push_back({pair, information * by_point * by_pair.transpose()});
}

// Subtracts W^T V^-1 W and W^T V^-1 g of each point; lower triangle only.
WindowEquations eliminate_points(HostEquations& host, double damping) {
  const Eigen::Index size = 6 * static_cast<Eigen::Index>(host.pairs.size());
  WindowEquations out{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  for (std::size_t i = 0; i < host.pairs.size(); ++i) {
    const Eigen::Index at = 6 * static_cast<Eigen::Index>(i);
    out.information.block<6, 6>(at, at) = host.pairs[i].H;
    out.gradient.segment<6>(at) = host.pairs[i].g;
  }
  std::vector<Eigen::Matrix<double, 6, 3>> weighted;
  for (PointEquations& point : host.points) {
    Eigen::Matrix3d V = point.V;
    V.diagonal() *= 1 + damping;
    point.inverse = V.inverse();
    if (!point.inverse.allFinite()) point.inverse.setZero();
    const std::span<const PointView> views(host.views.data() + point.first_view, point.views);
    weighted.clear();
    for (std::size_t a = 0; a < views.size(); ++a) {
      const Eigen::Index row = 6 * static_cast<Eigen::Index>(views[a].pair);
      weighted.emplace_back(views[a].W.transpose() * point.inverse);
      out.gradient.segment<6>(row).noalias() -= weighted[a] * point.g;
      for (std::size_t b = 0; b <= a; ++b) {
        const Eigen::Index column = 6 * static_cast<Eigen::Index>(views[b].pair);
        if (row >= column) {
          out.information.block<6, 6>(row, column).noalias() -= weighted[a] * views[b].W;
        } else {
          out.information.block<6, 6>(column, row).noalias() -= weighted[b] * views[a].W;
        }
      }
    }
  }
  return out;
}

// Adds equations of the pairs of a host, both triangles, to those of the window's variables.
void add_pairs(const HostEquations& host, const WindowEquations& pairs,
               const std::vector<int>& offsets, WindowEquations& out) {
  constexpr int kShared = PairEquations::kShared;
  const Eigen::Index size = pairs.gradient.size();
  Eigen::Matrix<double, Eigen::Dynamic, kShared> by_shared(size, kShared);
  for (std::size_t i = 0; i < host.pairs.size(); ++i) {
    by_shared.middleRows<6>(6 * static_cast<Eigen::Index>(i)) = host.pairs[i].by_shared;
  }
  const Eigen::Matrix<double, Eigen::Dynamic, kShared> weighted = pairs.information * by_shared;
  const Eigen::Matrix<double, kShared, kShared> shared = by_shared.transpose() * weighted;
  const Eigen::Matrix<double, kShared, 1> shared_g = by_shared.transpose() * pairs.gradient;
  const int h = offsets[host.host];
  out.information.topLeftCorner<kCommon, kCommon>() += shared.topLeftCorner<kCommon, kCommon>();
  out.information.block<kPose, kCommon>(h, 0) += shared.bottomLeftCorner<kPose, kCommon>();
  out.information.block<kPose, kPose>(h, h) += shared.bottomRightCorner<kPose, kPose>();
  out.gradient.head<kCommon>() += shared_g.head<kCommon>();
  out.gradient.segment<kPose>(h) += shared_g.tail<kPose>();
  for (std::size_t i = 0; i < host.pairs.size(); ++i) {
    const PairEquations& pair = host.pairs[i];
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(i);
    const int t = offsets[pair.target];
    const Eigen::Matrix<double, kPose, kShared> by =
        pair.by_target.transpose() * weighted.middleRows<6>(row);
    out.information.block<kPose, kCommon>(t, 0) += by.leftCols<kCommon>();
    if (t > h) {
      out.information.block<kPose, kPose>(t, h) += by.rightCols<kPose>();
    } else {
      out.information.block<kPose, kPose>(h, t) += by.rightCols<kPose>().transpose();
    }
    out.gradient.segment<kPose>(t).noalias() +=
        pair.by_target.transpose() * pairs.gradient.segment<6>(row);
    for (std::size_t k = 0; k < host.pairs.size(); ++k) {
      const int other = offsets[host.pairs[k].target];
      if (other > t) continue;
      const Eigen::Index column = 6 * static_cast<Eigen::Index>(k);
      out.information.block<kPose, kPose>(t, other).noalias() +=
          pair.by_target.transpose() * pairs.information.block<6, 6>(row, column) *
          host.pairs[k].by_target;
    }
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
  scope.alignments.resize(window.alignments.size());
  std::iota(scope.alignments.begin(), scope.alignments.end(), std::size_t{0});
  return scope;
}

Eigen::VectorXd error_from_first_estimates(const Window& window) {
  const std::vector<int> offsets = window.offsets();
  Eigen::VectorXd error = Eigen::VectorXd::Zero(offsets.back());
  error.head<kCommon>() << minus(window.extrinsics, window.first_extrinsics),
      minus(window.ground, window.first_ground);
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    const WindowFrame& frame = window.frames[i];
    if (!frame.first_estimate) continue;
    const InertialError d = minus(frame.state, *frame.first_estimate);
    error.segment(offsets[i], frame.size()) = d.head(frame.size());
  }
  return error;
}

WindowLinearization linearize(const Window& window, const WindowScope& scope) {
  WindowLinearization out;
  out.offsets = window.offsets();
  out.H = window.prior.information;
  out.g = window.prior.gradient - window.prior.information * error_from_first_estimates(window);
  for (const std::size_t end : scope.imu_frames) add_imu(window, end, out.offsets, out);
  for (const std::size_t i : scope.rest_frames) add_rest(window.frames[i], out.offsets[i], out);
  CameraPairs present(window, false);
  CameraPairs first(window, true);
  GroundViews present_ground(window, false);
  GroundViews first_ground(window, true);
  EquationsIndex index(window.frames.size());
  for (const std::size_t i : scope.tracks) {
    const WindowTrack& track = window.tracks[i];
    const std::size_t host = *window.find(track.observations.front().frame_id);
    std::optional<std::size_t>& host_at = index.host(host);
    if (!host_at) {
      host_at = out.hosts.size();
      out.hosts.push_back({.host = host, .pairs = {}, .points = {}, .views = {}});
    }
    HostEquations& equations = out.hosts[*host_at];
    PointEquations point;
    point.track = i;
    point.first_view = equations.views.size();
    add_host_observation(track, point);
    for (std::size_t k = 1; k < track.observations.size(); ++k) {
      const WindowObservation& observation = track.observations[k];
      if (observation.frame_id == scope.excluded_frame_id) continue;
      const std::size_t target = *window.find(observation.frame_id);
      std::optional<std::size_t>& pair_at = index.pair(host, target);
      if (!pair_at) {
        pair_at = equations.pairs.size();
        equations.pairs.push_back(pair_equations(window, host, target, first.at(host, target)));
      }
      add_view(observation, project_bearing(present.at(host, target), *track.point),
               project_point(first.at(host, target), *track.point), *pair_at, point, equations);
    }
    if (track.ground_information > 0) {
      std::optional<std::size_t>& ground_at = index.pair(host, host);
      if (!ground_at) {
        ground_at = equations.pairs.size();
        equations.pairs.push_back(ground_pair_equations(window, host));
      }
      add_ground(track, present_ground.at(host), first_ground.at(host), *ground_at, point,
                 equations);
    }
    point.views = equations.views.size() - point.first_view;
    equations.points.push_back(point);
  }
  if (!scope.alignments.empty()) {
    add_ground_alignments(window, scope.alignments, {present, first, present_ground, first_ground},
                          out);
  }
  return out;
}

WindowEquations eliminate_points(WindowLinearization& linear, double damping) {
  WindowEquations out{linear.H, linear.g};
  for (HostEquations& host : linear.hosts) {
    WindowEquations pairs = eliminate_points(host, damping);
    pairs.information.triangularView<Eigen::StrictlyUpper>() = pairs.information.transpose();
    add_pairs(host, pairs, linear.offsets, out);
  }
  return out;
}

std::vector<PairError> pair_errors(const HostEquations& host, const std::vector<int>& offsets,
                                   const Eigen::VectorXd& error) {
  Eigen::Matrix<double, PairEquations::kShared, 1> shared;
  shared << error.head<kCommon>(), error.segment<kPose>(offsets[host.host]);
  std::vector<PairError> out;
  out.reserve(host.pairs.size());
  for (const PairEquations& pair : host.pairs) {
    out.emplace_back(pair.by_shared * shared +
                     pair.by_target * error.segment<kPose>(offsets[pair.target]));
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
