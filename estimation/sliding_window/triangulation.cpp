#include "estimation/sliding_window/triangulation.hpp"

#include <Eigen/LU>
#include <cmath>

namespace stillkite {

std::optional<InverseDepthPoint> triangulate(const Window& window, const WindowTrack& track) {
  constexpr int kIterations = 4;
  constexpr double kMaxDepthSigma_ratio = 0.2;
  constexpr double kMaxError_ratio = 9;
  if (track.observations.size() < 3) return std::nullopt;
  const auto host = window.find(track.observations.front().frame_id);
  if (!host) return std::nullopt;
  const RigidTransform& world_from_host = window.frames[*host].state.world_from_imu;
  const RigidTransform& imu_from_camera = window.extrinsics.imu_from_camera;
  InverseDepthPoint point{track.observations.front().bearing, 0};
  double information = 0;
  double squared = 0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    information = squared = 0;
    double gradient = 0;
    for (std::size_t i = 1; i < track.observations.size(); ++i) {
      const WindowObservation& observation = track.observations[i];
      const RigidTransform& world_from_target =
          window.frames[*window.find(observation.frame_id)].state.world_from_imu;
      const auto seen =
          project_point(camera_pair(world_from_host, world_from_target, imu_from_camera), point);
      if (!seen) return std::nullopt;
      const Eigen::Vector2d residual = observation.bearing - seen->bearing;
      const Eigen::Vector2d by_depth = seen->by_point.col(2);
      const Eigen::Vector2d weighted = observation.information * by_depth;
      information += by_depth.dot(weighted);
      gradient += residual.dot(weighted);
      squared += residual.dot(observation.information * residual);
    }
    if (!(information > 0)) return std::nullopt;
    point.inverse_depth += gradient / information;
  }
  const double pairs = static_cast<double>(track.observations.size() - 1);
  const bool is_known = kMaxDepthSigma_ratio * point.inverse_depth > 1 / std::sqrt(information);
  if (!is_known || squared > 2 * kMaxError_ratio * pairs) return std::nullopt;
  return point;
}

}  // namespace stillkite
