#pragma once

#include <optional>
#include <variant>

#include "flow/frame.hpp"
#include "navigation/reference_config.hpp"

namespace stillkite {

/// The features of a reference frame, found again in later ones.
class FeatureAssociation {
 public:
  explicit FeatureAssociation(const ReferenceConfig& config);

  /// Nothing is found where the frame's mask hides it. False, and the former reference stays, where
  /// the image has fewer features than that. The first of its features are those that were
  /// followed up to here, where they are in the image.
  [[nodiscard]] bool set_reference(const Frame& frame, int min_features,
                                   const std::vector<cv::Point2f>& followed_px = {});
  /// The answer holds until the next call. The turn of the image since the reference, where it is
  /// known, spares a search most of its time.
  [[nodiscard]] const FeatureTracks& find(const Frame& frame,
                                          std::optional<double> known_turn_rad = {});

 private:
  DetectorConfig detector_;
  std::variant<FeatureTracker, OpenCvFeatureTracker, FeatureMatcher> method_;
  FeatureTracks tracks_;
};

}  // namespace stillkite
