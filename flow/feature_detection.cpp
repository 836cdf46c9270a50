#include "flow/feature_detection.hpp"

#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace stillkite {
namespace {

/// Key points with descriptors, one row each: bytes (ORB) or floats (SIFT).
struct DescribedFeatures {
  std::vector<cv::Point2f> points_px;
  cv::Mat descriptors;
};

cv::Ptr<cv::Feature2D> make_detector(const DetectorConfig& config) {
  if (config.kind == Detector::sift) return cv::SIFT::create(config.max_features);
  if (config.kind == Detector::orb) return cv::ORB::create(config.max_features);
  return cv::FastFeatureDetector::create(config.fast_threshold);
}

std::vector<cv::KeyPoint> detect_key_points(const cv::Mat& grey, const DetectorConfig& config,
                                            const cv::Mat& mask = cv::Mat()) {
  std::vector<cv::KeyPoint> found;
  if (config.kind == Detector::shi_tomasi) {
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(grey, corners, config.max_features, config.quality,
                            config.min_distance_px, mask, config.block_px);
    cv::KeyPoint::convert(corners, found, static_cast<float>(config.block_px));
    return found;
  }
  make_detector(config)->detect(grey, found, mask);
  cv::KeyPointsFilter::retainBest(found, config.max_features);
  return found;
}

DescribedFeatures describe_features(const cv::Mat& grey, const DetectorConfig& config) {
  std::vector<cv::KeyPoint> key_points = detect_key_points(grey, config);
  cv::Mat descriptors;
  // compute() removes key points too close to the border
  if (config.kind == Detector::sift) {
    cv::SIFT::create()->compute(grey, key_points, descriptors);
  } else {
    cv::ORB::create()->compute(grey, key_points, descriptors);
  }
  DescribedFeatures described{.points_px = {}, .descriptors = descriptors};
  cv::KeyPoint::convert(key_points, described.points_px);
  return described;
}

cv::FlannBasedMatcher make_matcher(int descriptor_type) {
  if (descriptor_type == CV_32F) return cv::FlannBasedMatcher();
  return cv::FlannBasedMatcher(cv::makePtr<cv::flann::LshIndexParams>(12, 20, 2));
}

}  // namespace

std::vector<cv::Point2f> detect_features(const cv::Mat& grey, const DetectorConfig& config,
                                         const std::vector<cv::Point2f>& tracked_px,
                                         const cv::Mat& mask) {
  cv::Mat detection_mask = mask;
  if (!tracked_px.empty()) {
    detection_mask = mask.empty() ? cv::Mat(grey.size(), CV_8U, cv::Scalar(255)) : mask.clone();
    const int radius_px = static_cast<int>(std::lround(config.min_distance_px));
    for (const cv::Point2f& at : tracked_px) cv::circle(detection_mask, at, radius_px, 0, -1);
  }
  std::vector<cv::Point2f> points_px;
  cv::KeyPoint::convert(detect_key_points(grey, config, detection_mask), points_px);
  return points_px;
}

std::vector<cv::Point2f> detect_features_in_half_size(const cv::Mat& grey,
                                                      const DetectorConfig& config,
                                                      const std::vector<cv::Point2f>& tracked_px,
                                                      const cv::Mat& mask) {
  const auto halved = [](const cv::Mat& image) {
    cv::Mat half;
    if (!image.empty()) cv::resize(image, half, {}, 0.5, 0.5, cv::INTER_AREA);
    return half;
  };
  // pixel centres are at whole numbers
  const cv::Point2f offset_px(0.5F, 0.5F);
  std::vector<cv::Point2f> tracked_half_px;
  tracked_half_px.reserve(tracked_px.size());
  for (const cv::Point2f& at : tracked_px) tracked_half_px.push_back(0.5F * (at - offset_px));
  DetectorConfig half_config = config;
  half_config.min_distance_px *= 0.5;
  std::vector<cv::Point2f> points_px =
      detect_features(halved(grey), half_config, tracked_half_px, halved(mask));
  for (cv::Point2f& at : points_px) at = 2 * at + offset_px;
  return points_px;
}

void FeatureMatcher::set_reference(const cv::Mat& grey) {
  DescribedFeatures described = describe_features(grey, config_);
  points_px_ = std::move(described.points_px);
  descriptors_ = std::move(described.descriptors);
}

FeatureMatches FeatureMatcher::match(const cv::Mat& grey) const {
  constexpr float kMaxDistanceRatio = 0.8F;
  const DescribedFeatures current = describe_features(grey, config_);
  FeatureMatches matches;
  if (descriptors_.rows < 2 || current.descriptors.rows < 2) return matches;
  std::vector<std::vector<cv::DMatch>> nearest;
  make_matcher(descriptors_.type()).knnMatch(descriptors_, current.descriptors, nearest, 2);
  for (const std::vector<cv::DMatch>& two : nearest) {
    if (two.size() < 2 || two[0].distance > kMaxDistanceRatio * two[1].distance) continue;
    matches.reference_px.push_back(points_px_[static_cast<std::size_t>(two[0].queryIdx)]);
    matches.current_px.push_back(current.points_px[static_cast<std::size_t>(two[0].trainIdx)]);
  }
  return matches;
}

}  // namespace stillkite
