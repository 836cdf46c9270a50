#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/fields.hpp"

namespace stillkite {

enum class Detector { shi_tomasi, fast, sift, orb };
template <>
struct EnumNames<Detector> {
  static constexpr auto value =
      std::to_array<std::pair<Detector, std::string_view>>({{Detector::shi_tomasi, "shi_tomasi"},
                                                            {Detector::fast, "fast"},
                                                            {Detector::sift, "sift"},
                                                            {Detector::orb, "orb"}});
};

/// Defaults: hold paper, section III.
struct DetectorConfig {
  Detector kind = Detector::shi_tomasi;
  int max_features = 3000;
  double quality = 0.01;
  double min_distance_px = 2;
  int block_px = 3;
  int fast_threshold = 20;

  static void fields(auto& self, auto&& field) {
    field("kind", self.kind, "feature detector; SURF (hold paper) is patented");
    field("max_features", self.max_features, Range{20, 20000},
          "maximum number of features, strongest first");
    field("quality", self.quality, Range{1e-6, 1},
          "shi_tomasi: minimum corner response as a ratio of the maximum");
    field("min_distance_px", self.min_distance_px, Range{0, 200},
          "shi_tomasi: minimum distance between corners");
    field("block_px", self.block_px, Range{2, 63},
          "shi_tomasi: side of the structure tensor's window");
    field("fast_threshold", self.fast_threshold, Range{1, 255},
          "fast: minimum grey difference on the circle");
  }
};

/// Features of a grey image, strongest first. Excludes a radius of `min_distance_px` about
/// `tracked_px` and the pixels where the mask (CV_8UC1; empty: no mask) is 0.
[[nodiscard]] std::vector<cv::Point2f> detect_features(
    const cv::Mat& grey, const DetectorConfig& config,
    const std::vector<cv::Point2f>& tracked_px = {}, const cv::Mat& mask = {});

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
