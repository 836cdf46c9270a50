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

/// The defaults are the hold paper's (section III).
struct DetectorConfig {
  Detector kind = Detector::shi_tomasi;
  int max_features = 3000;
  double quality = 0.01;
  double min_distance_px = 2;
  int block_px = 3;
  int fast_threshold = 20;

  static void fields(auto& self, auto&& field) {
    field("kind", self.kind, "how features are found; SURF, which the paper tried, is patented");
    field("max_features", self.max_features, Range{20, 20000}, "the strongest ones are kept");
    field("quality", self.quality, Range{1e-6, 1},
          "shi_tomasi: least strength of a corner, as a share of the strongest one's");
    field("min_distance_px", self.min_distance_px, Range{0, 200},
          "shi_tomasi: between two corners");
    field("block_px", self.block_px, Range{2, 63}, "shi_tomasi: side of the structure tensor");
    field("fast_threshold", self.fast_threshold, Range{1, 255},
          "fast: least difference of grey on the circle");
  }
};

/// Features of a grey image, the strongest first; none within `min_distance_px` of one of
/// `followed_px`, none where the mask (CV_8UC1; empty: none) is 0.
[[nodiscard]] std::vector<cv::Point2f> detect_features(
    const cv::Mat& grey, const DetectorConfig& config,
    const std::vector<cv::Point2f>& followed_px = {}, const cv::Mat& mask = {});

/// Places of the same features in two images.
struct FeatureMatches {
  std::vector<cv::Point2f> reference_px;
  std::vector<cv::Point2f> current_px;
};

/// Features of one image with what they look like, to be found among those of others: the way
/// that the hold paper tried and left (section III), a search without constraint on the distance.
class FeatureMatcher {
 public:
  explicit FeatureMatcher(const DetectorConfig& config) : config_(config) {}

  void set_reference(const cv::Mat& grey);
  /// FLANN's nearest neighbours, kept where they are clearly nearer than the second nearest (Lowe's
  /// ratio 0.8). SIFT and ORB bring descriptors of their own, corners get ORB's.
  [[nodiscard]] FeatureMatches match(const cv::Mat& grey) const;
  [[nodiscard]] int reference_count() const { return static_cast<int>(points_px_.size()); }

 private:
  DetectorConfig config_;
  std::vector<cv::Point2f> points_px_;
  cv::Mat descriptors_;
};

}  // namespace stillkite
