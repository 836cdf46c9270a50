#include "flow/feature_detection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

namespace stillkite {
namespace {

const std::vector<cv::Point2f> kSquares_px{{40, 30}, {120, 50}, {60, 90}, {140, 100}};
constexpr int kSide_px = 12;

cv::Mat squares() {
  cv::Mat grey(140, 180, CV_8U, cv::Scalar(60));
  for (const cv::Point2f& at : kSquares_px) {
    grey(cv::Rect(cv::Point(at), cv::Size(kSide_px, kSide_px))) = 200;
  }
  return grey;
}

// Distance to the nearest corner of a square.
double corner_distance_px(const cv::Point2f& point) {
  double nearest_px = 1e9;
  for (const cv::Point2f& square : kSquares_px) {
    for (const float x : {-0.5F, kSide_px - 0.5F}) {
      for (const float y : {-0.5F, kSide_px - 0.5F}) {
        nearest_px = std::min(nearest_px, cv::norm(point - square - cv::Point2f(x, y)));
      }
    }
  }
  return nearest_px;
}

TEST(FeatureDetection, HalfSizeFindsCornersAtTheirPositions) {
  const DetectorConfig config{.max_features = 50, .min_distance_px = 8};
  const auto points_px = detect_features_in_half_size(squares(), config, {});
  EXPECT_EQ(points_px.size(), 4 * kSquares_px.size());
  for (const cv::Point2f& at : points_px) EXPECT_LT(corner_distance_px(at), 2.5) << at;
}

TEST(FeatureDetection, HalfSizeLeavesOutKnownAndMaskedFeatures) {
  const DetectorConfig config{.max_features = 50, .min_distance_px = 20};
  cv::Mat mask(140, 180, CV_8U, cv::Scalar(255));
  mask.rowRange(75, 140) = 0;
  const cv::Point2f known_px = kSquares_px.front() + cv::Point2f(6, 6);
  const auto points_px = detect_features_in_half_size(squares(), config, {known_px}, mask);
  ASSERT_FALSE(points_px.empty());
  for (const cv::Point2f& at : points_px) {
    EXPECT_LT(at.y, 75);
    EXPECT_GT(cv::norm(at - known_px), 19);
  }
}

}  // namespace
}  // namespace stillkite
