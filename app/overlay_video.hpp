#pragma once

#include <filesystem>
#include <optional>

#include "flow/frame.hpp"
#include "io/video/overlay.hpp"
#include "io/video/video_writer.hpp"

namespace stillkite {

/// overlay.mp4: one annotated image per frame, at the rate of the first two frames.
class OverlayVideo {
 public:
  OverlayVideo(std::filesystem::path file, const Camera& camera,
               const RigidTransform& body_from_camera);

  void add(const Frame& frame, const NavigationEstimate& estimate,
           std::span<const WeightedFlow> flow_vectors);

  /// Flushes the file under a temporary name.
  void finish();

  /// Renames the file to its final name. A video of one frame lasts one second; without frames no
  /// file is written.
  void commit();

 private:
  void open(double frames_per_s);

  std::filesystem::path file_;
  Overlay overlay_;
  cv::Mat first_;  // stored until the frame rate is available
  Timestamp first_stamp_;
  std::optional<VideoWriter> writer_;
};

}  // namespace stillkite
