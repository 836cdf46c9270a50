#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "estimation/plane/keyframe_view.hpp"

namespace stillkite {

/// Rotation between consecutive frames by the images alone: difference of their alignments to a
/// keyframe. Sensors are only the initial value of an alignment.
class ImageRotation {
 public:
  /// Mean angular rate since the previous frame, in camera axes; empty unless both are aligned.
  /// `view`: alignment of this frame to the keyframe before; `is_keyframe`: this frame replaces it.
  std::optional<Eigen::Vector3d> update(const std::optional<KeyframeView>& view, bool is_keyframe,
                                        double dt_s);

 private:
  std::optional<Eigen::Quaterniond> camera_from_keyframe_;  // of the last frame
};

}  // namespace stillkite
