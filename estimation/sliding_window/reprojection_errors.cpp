#include "estimation/sliding_window/reprojection_errors.hpp"

#include <limits>

namespace stillkite {

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

const GroundView& GroundViews::at(std::size_t frame) {
  std::optional<GroundView>& view = views_[frame];
  if (!view) {
    const double shift_s = window_.image_shift_s();
    const CameraExtrinsics& extrinsics =
        at_first_estimates_ ? window_.first_extrinsics : window_.extrinsics;
    view = ground_view(at_first_estimates_ ? window_.first_ground : window_.ground,
                       window_.frames[frame].world_from_imu_after(shift_s, at_first_estimates_),
                       extrinsics.imu_from_camera);
  }
  return *view;
}

double inverse_depth_information(const CameraPair& pair, const InverseDepthPoint& point,
                                 const WindowObservation& observation) {
  const auto projection = project_point(pair, point);
  if (!projection) return 0;
  const Eigen::Vector2d by_depth = projection->by_point.col(2);
  return by_depth.dot(observation.information * by_depth);
}

std::optional<Eigen::Vector2d> ReprojectionErrors::residual(const WindowTrack& track,
                                                            const WindowObservation& observation) {
  const std::size_t host = *window_.find(track.observations.front().frame_id);
  const std::size_t target = *window_.find(observation.frame_id);
  const auto seen = project_bearing(pairs_.at(host, target), *track.point);
  if (!seen) return std::nullopt;
  return observation.bearing - *seen;
}

double ReprojectionErrors::squared(const WindowTrack& track, const WindowObservation& observation) {
  const auto error = residual(track, observation);
  if (!error) return std::numeric_limits<double>::infinity();
  return error->dot(observation.information * *error);
}

}  // namespace stillkite
