#pragma once

#include <optional>
#include <variant>

#include "flow/feature_detection.hpp"
#include "flow/feature_tracker.hpp"
#include "flow/frame.hpp"
#include "flow/opencv_feature_tracker.hpp"
#include "navigation/reference_config.hpp"

namespace stillkite {

/// Association of a reference frame's features with later frames, by the configured method.
class FeatureAssociation {
 public:
  explicit FeatureAssociation(const ReferenceConfig& config);

  /// Detects features outside the frame's mask; those at `tracked_px` are kept and come first.
  /// Returns false and keeps the former reference if fewer than `min_features` are found.
  [[nodiscard]] bool set_reference(const Frame& frame, int min_features,
                                   const std::vector<cv::Point2f>& tracked_px = {});
  /// Feature tracks from the reference to `frame`, valid until the next call.
  /// `image_rotation_rad`: prior of the image rotation since the reference; speeds up a search.
  [[nodiscard]] const FeatureTracks& associate(const Frame& frame,
                                               std::optional<double> image_rotation_rad = {});

 private:
  DetectorConfig detector_;
  std::variant<FeatureTracker, OpenCvFeatureTracker, FeatureMatcher> method_;
  FeatureTracks tracks_;
};

}  // namespace stillkite
