#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "flow/feature_tracker.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// The defaults are the hold paper's (section III).
struct OpenCvFeatureTrackerConfig {
  int window_px = 35;
  int max_level = 3;

  static void fields(auto& self, auto&& field) {
    field("window_px", self.window_px, Range{3, 99}, "side of the Lucas-Kanade window");
    field("max_level", self.max_level, Range{0, 8}, "coarsest level, the full image being 0");
  }
};

/// The hold paper's association: pyramidal Lucas-Kanade (Bouguet) of the reference's features, from
/// their place in the reference, in every frame anew.
class OpenCvFeatureTracker {
 public:
  explicit OpenCvFeatureTracker(const OpenCvFeatureTrackerConfig& config) : config_(config) {}

  void set_reference(const cv::Mat& grey, const std::vector<cv::Point2f>& features_px);

  /// Features that LK lost, or that left the image, are not `found`.
  const FeatureTracks& track(const cv::Mat& grey);

 private:
  OpenCvFeatureTrackerConfig config_;
  std::vector<cv::Mat> reference_pyramid_;
  std::vector<cv::Point2f> reference_px_, current_px_;
  std::vector<unsigned char> status_;
  std::vector<float> errors_;
  FeatureTracks tracks_;
};

}  // namespace stillkite
