#include "io/dataset/initial_state.hpp"

#include <fmt/core.h>

#include <cstddef>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"

namespace stillkite {
namespace {

InitialState initial_state_from_truth(const std::vector<StampedPose>& truth, Timestamp first) {
  if (truth.empty()) {
    throw InputError("initial.from_truth: no truth; set truth.path, or initial.height_m instead");
  }
  const double delay_s = seconds_between(first, truth.front().stamp);
  if (delay_s > 0.1 || first > truth.back().stamp) {
    throw InputError(fmt::format(
        "initial.from_truth: the truth covers {} s to {} s, the first frame is at {} s; "
        "choose source.start_s within the truth, or set truth.time_offset_s",
        to_seconds(truth.front().stamp), to_seconds(truth.back().stamp), to_seconds(first)));
  }
  std::size_t i = 0;
  while (i + 1 < truth.size() && truth[i + 1].stamp <= first) ++i;
  RigidTransform pose = truth[i].world_from_body;
  if (i + 1 < truth.size() && first > truth[i].stamp) {
    const double gap_s = seconds_between(truth[i].stamp, truth[i + 1].stamp);
    pose = interpolate(pose, truth[i + 1].world_from_body,
                       seconds_between(truth[i].stamp, first) / gap_s);
  }
  return {.world_from_body = pose, .scale = ScaleSource::initial_height};
}

}  // namespace

InitialState initial_state(const RunConfig& config, const GroundTruth& truth,
                           const SensorLog& sensors, Timestamp first) {
  const SensorReadings readings = readings_between(sensors, first, first);
  const Eigen::Quaterniond attitude =
      readings.attitude.value_or(to_quaternion({.yaw_rad = config.initial.yaw_deg * kDegree,
                                                .pitch_rad = config.initial.pitch_deg * kDegree,
                                                .roll_rad = config.initial.roll_deg * kDegree}));
  if (config.initial.from_truth) {
    if (config.initial.height_m) {
      throw InputError(
          "initial.from_truth and initial.height_m are both set; keep one "
          "(initial.from_truth=false "
          "uses the height)");
    }
    InitialState initial = initial_state_from_truth(truth.poses, first);
    if (!truth.has_attitude) initial.world_from_body.rotation = attitude;
    return initial;
  }
  InitialState initial;
  initial.world_from_body.rotation = attitude;
  initial.world_from_body.translation.z() = 1.0;
  if (config.initial.height_m) {
    initial.world_from_body.translation.z() = *config.initial.height_m;
    initial.scale = ScaleSource::initial_height;
  } else if (config.height.source == HeightSource::range && readings.height_m) {
    initial.world_from_body.translation.z() =
        height_of_body_m(*readings.height_m, ScaleSource::range, initial.world_from_body.rotation);
    initial.scale = ScaleSource::range;
  }
  return initial;
}

}  // namespace stillkite
