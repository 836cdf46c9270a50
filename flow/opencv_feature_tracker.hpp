#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "flow/feature_tracker_config.hpp"
#include "flow/feature_tracks.hpp"

namespace stillkite {

/// Feature tracking of the hold paper: pyramidal Lucas-Kanade (Bouguet) from the reference image,
/// initialized in every frame at the reference positions.
class OpenCvFeatureTracker {
 public:
  explicit OpenCvFeatureTracker(const OpenCvFeatureTrackerConfig& config) : config_(config) {}

  void set_reference(const cv::Mat& grey, const std::vector<cv::Point2f>& features_px);

  /// `found` is 0 for features that were lost or left the image. No covariances. Valid until the
  /// next call.
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
