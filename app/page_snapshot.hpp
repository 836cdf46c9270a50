#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"
#include "live/capture_counts.hpp"
#include "navigation/pilot_step.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

/// Result of one image, for the operator's page. Times are of the local clock.
struct PageSnapshot {
  std::int64_t number = 0;  ///< ascends
  PilotStep step;
  cv::Mat grey;                            ///< pixels are shared
  std::vector<WeightedFlow> flow_vectors;  ///< empty if nobody watches
  Camera camera;
  RigidTransform body_from_camera;
  Timestamp estimated;
  std::optional<Timestamp> measured;  ///< last image with a measured motion
  double latency_s = 0;               ///< from arrival to estimate; NaN: unknown
};

/// State of a live flight that changes without images, too.
struct FlightStatus {
  /// Playback of a record.
  struct Replay {
    double speed = 1;   ///< multiple of real time
    double time_s = 0;  ///< in flight, since the first image
    bool has_ended = false;
  };
  bool has_station = false;   ///< there is a ground station to command
  bool is_supervised = true;  ///< the supervising process runs
  bool is_engaged = false, is_stopped = false;
  bool is_waiting_for_telemetry = false;
  CaptureCounts images;
  std::int64_t used_images = 0;
  std::optional<Replay> replay;  ///< nullopt in flight
};

}  // namespace stillkite
