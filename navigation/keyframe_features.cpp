#include "navigation/keyframe_features.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "flow/feature_detection.hpp"
#include "flow/image_mask.hpp"

namespace stillkite {
namespace {

constexpr int kFeatures = 200;

// Errors of a patch are 1 to 1.6 standard deviations of its covariance (FeatureTracks).
constexpr double kMaxErrorSigmas = 1.6;
// Variance of a feature in the image where it is detected: its patch is the reference of all
// others.
constexpr double kMinVariance_px2 = 0.02 * 0.02;

// Spread over the image: two thirds of the spacing of a regular grid of so many.
DetectorConfig spread_detector(const Camera& camera) {
  DetectorConfig config;
  config.max_features = kFeatures;
  config.min_distance_px =
      std::sqrt(camera.width_px * static_cast<double>(camera.height_px) / kFeatures) * 2 / 3;
  return config;
}

// As PatchAlignment::set_reference places the patch of a feature.
Eigen::Vector2f patch_centre_px(const cv::Point2f& feature) {
  return {std::round(feature.x) - 0.5F, std::round(feature.y) - 0.5F};
}

}  // namespace

KeyframeFeatures::KeyframeFeatures(const Camera& camera, double lens_sigma_px)
    : camera_(camera),
      detector_(spread_detector(camera)),
      lens_sigma_px_(lens_sigma_px),
      tracker_(FeatureTrackerConfig{}) {}

std::vector<FeatureObservation> KeyframeFeatures::track(const Frame& frame) {
  std::swap(previous_, found_);
  found_.clear();
  tracker_.set_mask(frame.mask);
  const FeatureTracks& tracks = tracker_.track(frame.grey, {}, expected_flow_px(frame.stamp));
  for (std::size_t i = 0; i < features_.size(); ++i) {
    if (tracks.found[i] == 0) continue;
    // the feature moves as the centre of its patch, at most half a pixel away
    const Eigen::Vector2f offset_px = features_[i].at_px - features_[i].patch_px;
    found_.push_back({i, tracks.current_px[i] + offset_px,
                      features_[i].covariance_px2 + tracks.covariance_px2[i]});
  }
  update_flow(frame.stamp);
  return observations(found_);
}

// The image moves on as in the last interval.
AffineFlow KeyframeFeatures::expected_flow_px(Timestamp stamp) const {
  if (!(interval_s_ > 0)) return {};
  const auto ratio = static_cast<float>(seconds_between(last_, stamp) / interval_s_);
  AffineFlow expected_px = flow_px_;
  expected_px.offset_px *= ratio;
  expected_px.gradient *= ratio;
  return expected_px;
}

void KeyframeFeatures::update_flow(Timestamp stamp) {
  std::vector<Eigen::Vector2f> from_px, displacements_px;
  auto before = previous_.begin();
  for (const Found& now : found_) {
    while (before != previous_.end() && before->feature < now.feature) ++before;
    if (before == previous_.end()) break;
    if (before->feature != now.feature) continue;
    from_px.push_back(before->at_px);
    displacements_px.emplace_back(now.at_px - before->at_px);
  }
  flow_px_ =
      fit_affine_flow(from_px, displacements_px, std::vector<unsigned char>(from_px.size(), 1));
  interval_s_ = from_px.empty() ? 0 : seconds_between(last_, stamp);
  last_ = stamp;
}

std::vector<FeatureObservation> KeyframeFeatures::take_keyframe(const Frame& frame) {
  last_ = frame.stamp;
  std::vector<cv::Point2f> points_px;
  std::vector<Feature> features;
  std::vector<Found> found;
  // a patch's centre is half a pixel from its feature
  for (const Found& old : found_) {
    points_px.emplace_back(old.at_px.x() + 0.5F, old.at_px.y() + 0.5F);
    features.push_back({.track_id = features_[old.feature].track_id,
                        .at_px = old.at_px,
                        .covariance_px2 = old.covariance_px2});
    found.push_back(old);
  }
  DetectorConfig detector = detector_;
  detector.max_features = std::max(20, kFeatures - static_cast<int>(found_.size()));
  for (const cv::Point2f& point : detect_features_in_half_size(
           frame.grey, detector, points_px, frame.mask ? frame.mask->valid_pixels() : cv::Mat())) {
    points_px.push_back(point);
    const Eigen::Vector2f at_px = patch_centre_px(point);
    features.push_back({.track_id = next_track_id_++, .at_px = at_px});
    found.push_back({0, at_px, Eigen::Matrix2f::Zero()});
  }
  constexpr std::size_t kMinFeatures = 20;
  if (points_px.size() < kMinFeatures) return {};
  tracker_.set_reference(frame.grey, points_px);
  // the tracker leaves out patches that exceed the image
  const std::vector<Eigen::Vector2f>& kept_px = tracker_.reference_px();
  features_.clear();
  found_.clear();
  for (std::size_t i = 0; i < points_px.size() && features_.size() < kept_px.size(); ++i) {
    const Eigen::Vector2f patch_px = patch_centre_px(points_px[i]);
    if (patch_px != kept_px[features_.size()]) continue;
    found[i].feature = features_.size();
    found_.push_back(found[i]);
    features[i].patch_px = patch_px;
    features_.push_back(features[i]);
  }
  return observations(found_);
}

std::vector<FeatureObservation> KeyframeFeatures::observations(
    const std::vector<Found>& found) const {
  std::vector<FeatureObservation> out;
  out.reserve(found.size());
  for (const Found& feature : found) {
    const std::optional<Eigen::Vector2d> bearing = undistort(camera_, feature.at_px.cast<double>());
    if (!bearing) continue;
    const Eigen::Matrix2d by_pixel = distort(camera_, *bearing).jacobian.inverse();
    const Eigen::Matrix2d covariance_px2 =
        kMaxErrorSigmas * kMaxErrorSigmas * feature.covariance_px2.cast<double>() +
        (lens_sigma_px_ * lens_sigma_px_ + kMinVariance_px2) * Eigen::Matrix2d::Identity();
    out.push_back({features_[feature.feature].track_id, *bearing,
                   by_pixel * covariance_px2 * by_pixel.transpose()});
  }
  return out;
}

bool KeyframeFeatures::needs_keyframe(const Eigen::Quaterniond& keyframe_from_camera) const {
  constexpr double kMinFoundRatio = 0.6;
  constexpr double kMaxParallax = 0.05;  // on z = 1
  const double min_found = kMinFoundRatio * static_cast<double>(features_.size());
  if (static_cast<double>(found_.size()) < min_found) return true;
  std::vector<double> parallaxes;
  parallaxes.reserve(found_.size());
  for (const Found& found : found_) {
    const auto now = undistort(camera_, found.at_px.cast<double>());
    const auto before = undistort(camera_, features_[found.feature].at_px.cast<double>());
    if (!now || !before) continue;
    const Eigen::Vector3d rotated = keyframe_from_camera * now->homogeneous();
    if (!(rotated.z() > 0)) continue;
    parallaxes.push_back((rotated.hnormalized() - *before).norm());
  }
  if (parallaxes.empty()) return true;
  const auto middle = parallaxes.begin() + static_cast<std::ptrdiff_t>(parallaxes.size() / 2);
  std::nth_element(parallaxes.begin(), middle, parallaxes.end());
  return *middle > kMaxParallax;
}

std::vector<WeightedFlow> KeyframeFeatures::flow_vectors() const {
  std::vector<WeightedFlow> vectors;
  vectors.reserve(found_.size());
  for (const Found& found : found_) {
    vectors.push_back({.centre_px = found.at_px,
                       .flow_px = found.at_px - features_[found.feature].at_px,
                       .weight = 1.0F});
  }
  return vectors;
}

}  // namespace stillkite
