#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "flow/detector_config.hpp"

namespace stillkite {

/// Features of a grey image, strongest first. Excludes a radius of `min_distance_px` about
/// `tracked_px` and the pixels where the mask (CV_8UC1; empty: no mask) is 0.
[[nodiscard]] std::vector<cv::Point2f> detect_features(
    const cv::Mat& grey, const DetectorConfig& config,
    const std::vector<cv::Point2f>& tracked_px = {}, const cv::Mat& mask = {});

/// The same in the image of half the size, at a quarter of the time; all arguments and the result
/// are those of the full size. Positions are multiples of two pixels, plus a half.
[[nodiscard]] std::vector<cv::Point2f> detect_features_in_half_size(
    const cv::Mat& grey, const DetectorConfig& config, const std::vector<cv::Point2f>& tracked_px,
    const cv::Mat& mask = {});

/// Positions of corresponding features in two images.
struct FeatureMatches {
  std::vector<cv::Point2f> reference_px;
  std::vector<cv::Point2f> current_px;
};

/// Descriptor matching against a reference image without a distance constraint: the alternative
/// that the hold paper (section III) tested and rejected.
class FeatureMatcher {
 public:
  explicit FeatureMatcher(const DetectorConfig& config) : config_(config) {}

  void set_reference(const cv::Mat& grey);
  /// FLANN nearest neighbours that pass Lowe's ratio test (0.8). SIFT and ORB use their own
  /// descriptors, the corner detectors ORB's. Fewer than 2 features in either image: no matches.
  [[nodiscard]] FeatureMatches match(const cv::Mat& grey) const;
  [[nodiscard]] int reference_count() const { return static_cast<int>(points_px_.size()); }

 private:
  DetectorConfig config_;
  std::vector<cv::Point2f> points_px_;
  cv::Mat descriptors_;
};

}  // namespace stillkite
