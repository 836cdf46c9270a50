#include "recording.hpp"

#include <algorithm>

#include "geometry/fields.hpp"
#include "io/dataset/flight_inputs.hpp"
#include "io/dataset/imu_description.hpp"
#include "io/video/frame_source.hpp"

namespace stillkite::bench {
namespace {

// Sensors begin before the first image; an interval is interpolated from the readings around it.
constexpr double kMargin_s = 0.5;

struct Interval {
  Timestamp first;
  Timestamp last;

  [[nodiscard]] bool contains(Timestamp stamp) const { return first <= stamp && stamp <= last; }
  [[nodiscard]] Interval widened(double margin_s) const {
    const std::int64_t margin_ns = from_seconds(margin_s).ns;
    return {{first.ns - margin_ns}, {last.ns + margin_ns}};
  }
};

template <typename Stamped>
std::vector<Stamped> within(const std::vector<Stamped>& series, const Interval& interval) {
  std::vector<Stamped> part;
  std::ranges::copy_if(series, std::back_inserter(part),
                       [&](const Stamped& element) { return interval.contains(element.stamp); });
  return part;
}

TimeSeries<Vector6d> within(const TimeSeries<Vector6d>& series, const Interval& interval) {
  TimeSeries<Vector6d> part;
  for (std::size_t i = 0; i < series.stamps.size(); ++i) {
    if (!interval.contains(series.stamps[i])) continue;
    part.stamps.push_back(series.stamps[i]);
    part.values.push_back(series.values[i]);
  }
  return part;
}

}  // namespace

Recording read_recording(const RunConfig& config) {
  FrameSource source(config.source);
  const FlightInputs inputs = read_flight_inputs(config, source.first());
  Recording recording{.camera = inputs.camera,
                      .body_from_camera = inputs.body_from_camera,
                      .images = {},
                      .poses = inputs.truth.poses,
                      .twists_in_camera = inputs.truth.twists_in_camera,
                      .imu = inputs.sensors.imu,
                      .imu_noise = {}};
  while (const auto frame = source.next()) {
    recording.images.push_back({frame->recorded_stamp, frame->grey.clone()});
  }
  if (config.imu.path) {
    if (const auto description = read_imu_description(*config.imu.path)) {
      recording.imu_noise = description->noise;
    }
  }
  return recording;
}

Recording part_of(const Recording& recording, double from_ratio, double to_ratio) {
  const Timestamp first = recording.images.front().stamp;
  const auto at = [&](double ratio) {
    const double duration_s = seconds_between(first, recording.images.back().stamp);
    return Timestamp{first.ns + from_seconds(ratio * duration_s).ns};
  };
  Recording part = recording;
  part.images = within(recording.images, {at(from_ratio), at(to_ratio)});
  if (part.images.size() < 2) throw InputError("this part of the recording has no two images");
  const Interval kept{part.images.front().stamp, part.images.back().stamp};
  part.poses = within(recording.poses, kept.widened(kMargin_s));
  part.twists_in_camera = within(recording.twists_in_camera, kept);
  part.imu = within(recording.imu, kept.widened(kMargin_s));
  return part;
}

}  // namespace stillkite::bench
