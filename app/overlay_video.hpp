#pragma once

#include <filesystem>
#include <optional>

#include "flow/frame.hpp"
#include "io/video/overlay.hpp"
#include "io/video/video_writer.hpp"

namespace stillkite {

/// The file overlay.mp4, a drawn image a frame, at the rate of the first two frames.
class OverlayVideo {
 public:
  OverlayVideo(std::filesystem::path file, const Camera& camera,
               const RigidTransform& body_from_camera);

  void add(const Frame& frame, const NavigationEstimate& estimate,
           std::span<const WindowFlow> windows);

  /// The file is on the disk, and only its name is missing.
  void finish();

  /// The file gets its name. A video of one frame lasts a second; without any there is none.
  void commit();

 private:
  void open(double frames_per_s);

  std::filesystem::path file_;
  Overlay overlay_;
  cv::Mat first_;  // until the rate is known
  Timestamp first_stamp_;
  std::optional<VideoWriter> writer_;
};

}  // namespace stillkite
