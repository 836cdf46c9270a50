#include "navigation/keyframe_features.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "small_camera.hpp"

namespace stillkite {
namespace {

cv::Mat blurred_noise(const Camera& camera, cv::RNG& random) {
  cv::Mat texture(camera.height_px, camera.width_px, CV_32F);
  random.fill(texture, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(texture, texture, {}, 2);
  cv::normalize(texture, texture, 40, 215, cv::NORM_MINMAX);
  return texture;
}

Frame noisy_image(const cv::Mat& texture, int index, cv::RNG& random) {
  constexpr double kNoise_grey = 8;
  cv::Mat noise(texture.size(), CV_32F);
  random.fill(noise, cv::RNG::NORMAL, 0, kNoise_grey);
  Frame frame{.stamp = from_seconds(0.05 * index)};
  cv::Mat(texture + noise).convertTo(frame.grey, CV_8U);
  return frame;
}

// Mean squared error of features of a camera at rest, over its covariance.
double normalized_error(const std::vector<FeatureObservation>& features,
                        const std::map<std::int64_t, Eigen::Vector2d>& truth) {
  double sum = 0;
  int count = 0;
  for (const FeatureObservation& feature : features) {
    const auto at = truth.find(feature.track_id);
    if (at == truth.end()) continue;
    const Eigen::Vector2d error = feature.bearing - at->second;
    sum += error.dot(feature.covariance.ldlt().solve(error));
    ++count;
  }
  EXPECT_GT(count, 50);
  return sum / std::max(1, count);
}

// Every image is a keyframe: the errors of the alignments add up, and so do their covariances.
TEST(KeyframeFeatures, CovarianceGrowsFromKeyframeToKeyframe) {
  constexpr int kKeyframes = 15;
  const Camera camera = small_camera();
  cv::RNG random(7);
  const cv::Mat texture = blurred_noise(camera, random);
  KeyframeFeatures features(camera, 0);
  std::map<std::int64_t, Eigen::Vector2d> truth;
  for (const FeatureObservation& feature :
       features.take_keyframe(noisy_image(texture, 0, random)).features) {
    truth[feature.track_id] = feature.bearing;
  }
  double first = 0;
  double last = 0;
  for (int i = 1; i <= kKeyframes; ++i) {
    const Frame frame = noisy_image(texture, i, random);
    last = normalized_error(features.track(frame), truth);
    if (i == 1) first = last;
    ASSERT_FALSE(features.take_keyframe(frame).features.empty());
  }
  EXPECT_GT(first, 0);
  EXPECT_LT(last, 2 * first);
}

// Every image is a keyframe: those of the reference are aligned to its image.
TEST(KeyframeFeatures, ReferenceFeaturesDoNotDrift) {
  constexpr int kKeyframes = 10;
  const Camera camera = small_camera();
  cv::RNG random(9);
  const cv::Mat texture = blurred_noise(camera, random);
  KeyframeFeatures features(camera, 0);
  std::vector<ExpectedFeature> expected;
  std::map<std::int64_t, Eigen::Vector2d> truth;
  for (const FeatureObservation& feature :
       features.take_keyframe(noisy_image(texture, 0, random)).features) {
    expected.push_back({feature.track_id, feature.bearing});
    truth[feature.track_id] = feature.bearing;
  }
  features.keep_as_reference();
  std::vector<double> variances;
  std::vector<FeatureObservation> realigned;
  for (int i = 1; i <= kKeyframes; ++i) {
    const Frame frame = noisy_image(texture, i, random);
    (void)features.track(frame);
    const KeyframeFeatures::Keyframe keyframe = features.take_keyframe(frame, expected);
    ASSERT_LT(keyframe.features.size(), 1.2 * static_cast<double>(expected.size()));
    if (i == 1) continue;  // the keyframe before is the reference
    realigned = keyframe.realigned;
    ASSERT_GT(realigned.size(), 50U);
    double sum = 0;
    for (const FeatureObservation& feature : realigned) sum += feature.covariance.trace();
    variances.push_back(sum / static_cast<double>(realigned.size()));
  }
  EXPECT_LT(variances.back(), 1.2 * variances.front());
  EXPECT_LT(normalized_error(realigned, truth), 3);
}

}  // namespace
}  // namespace stillkite
