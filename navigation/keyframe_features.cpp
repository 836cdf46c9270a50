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
    : camera_(camera), detector_(spread_detector(camera)), lens_sigma_px_(lens_sigma_px) {}

std::vector<FeatureObservation> KeyframeFeatures::track(const Frame& frame) {
  std::swap(previous_, found_);
  keyframe_.tracker.set_mask(frame.mask);
  found_ = found_in(keyframe_.features,
                    keyframe_.tracker.track(frame.grey, {}, expected_flow_px(frame.stamp)));
  update_flow(frame.stamp);
  return observations(keyframe_.features, found_);
}

// A feature moves as the centre of its patch, at most half a pixel away.
std::vector<KeyframeFeatures::Found> KeyframeFeatures::found_in(
    const std::vector<Feature>& features, const FeatureTracks& tracks) {
  std::vector<Found> found;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (tracks.found[i] == 0) continue;
    const Eigen::Vector2f offset_px = features[i].at_px - features[i].patch_px;
    found.push_back({i, tracks.current_px[i] + offset_px,
                     features[i].covariance_px2 + tracks.covariance_px2[i]});
  }
  return found;
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

KeyframeFeatures::Keyframe KeyframeFeatures::take_keyframe(
    const Frame& frame, std::span<const ExpectedFeature> expected) {
  last_ = frame.stamp;
  const std::vector<Found> realigned = realign(frame, expected);
  std::vector<Feature> features = continued_features(realigned);
  std::vector<cv::Point2f> points_px;
  points_px.reserve(features.size());
  // a patch's centre is half a pixel from its feature
  for (const Feature& old : features) {
    points_px.emplace_back(old.at_px.x() + 0.5F, old.at_px.y() + 0.5F);
  }
  DetectorConfig detector = detector_;
  detector.max_features = std::max(20, kFeatures - static_cast<int>(features.size()));
  for (const cv::Point2f& point : detect_features_in_half_size(
           frame.grey, detector, points_px, frame.mask ? frame.mask->valid_pixels() : cv::Mat())) {
    points_px.push_back(point);
    features.push_back({.track_id = next_track_id_++, .at_px = patch_centre_px(point)});
  }
  constexpr std::size_t kMinFeatures = 20;
  if (points_px.size() < kMinFeatures) return {};
  Keyframe out;
  out.realigned = observations(reference_.features, realigned);
  if (is_reference_) reference_ = std::exchange(keyframe_, {});
  is_reference_ = false;
  keyframe_.tracker.set_mask(frame.mask);
  keyframe_.tracker.set_reference(frame.grey, points_px);
  // the tracker leaves out patches that exceed the image
  const std::vector<Eigen::Vector2f>& kept_px = keyframe_.tracker.reference_px();
  keyframe_.features.clear();
  found_.clear();
  for (std::size_t i = 0; i < points_px.size() && found_.size() < kept_px.size(); ++i) {
    features[i].patch_px = patch_centre_px(points_px[i]);
    if (features[i].patch_px != kept_px[found_.size()]) continue;
    found_.push_back({found_.size(), features[i].at_px, features[i].covariance_px2});
    keyframe_.features.push_back(features[i]);
  }
  out.features = observations(keyframe_.features, found_);
  return out;
}

// Aligns the features of the reference keyframe to an image, from their common expected motion.
std::vector<KeyframeFeatures::Found> KeyframeFeatures::realign(
    const Frame& frame, std::span<const ExpectedFeature> expected) {
  constexpr std::size_t kMinFeatures = PatchAlignment::kMinMotionFeatures;
  std::vector<Eigen::Vector2f> from_px, displacements_px;
  std::vector<unsigned char> is_expected(reference_.features.size(), 0);
  auto feature = expected.begin();
  for (std::size_t i = 0; i < reference_.features.size(); ++i) {
    const Feature& reference = reference_.features[i];
    while (feature != expected.end() && feature->track_id < reference.track_id) ++feature;
    if (feature == expected.end()) break;
    if (feature->track_id != reference.track_id) continue;
    const Eigen::Vector2d at_px = distort(camera_, feature->bearing).pixel;
    const bool is_inside = at_px.x() > 0 && at_px.y() > 0 && at_px.x() < camera_.width_px &&
                           at_px.y() < camera_.height_px;
    if (!is_inside) continue;
    is_expected[i] = 1;
    from_px.push_back(reference.at_px);
    displacements_px.emplace_back(at_px.cast<float>() - reference.at_px);
  }
  if (from_px.size() < kMinFeatures) return {};
  const AffineFlow motion_px =
      fit_affine_flow(from_px, displacements_px, std::vector<unsigned char>(from_px.size(), 1));
  reference_.tracker.set_mask(frame.mask);
  std::vector<Found> found =
      found_in(reference_.features, reference_.tracker.track_from(frame.grey, motion_px));
  std::erase_if(found, [&](const Found& f) { return is_expected[f.feature] == 0; });
  return found;
}

std::vector<FeatureObservation> KeyframeFeatures::search_lost(const Frame& frame) {
  if (lost_.features.empty()) return {};
  lost_.tracker.set_mask(frame.mask);
  return observations(lost_.features, found_in(lost_.features, lost_.tracker.track(frame.grey)));
}

// Features of the keyframe that are found in the last image. Those of the reference keyframe are
// where they are realigned; others close to them are left out, so that their number does not grow.
std::vector<KeyframeFeatures::Feature> KeyframeFeatures::continued_features(
    const std::vector<Found>& realigned) const {
  const auto min_distance_px = static_cast<float>(0.5 * detector_.min_distance_px);
  std::vector<Feature> features;
  features.reserve(realigned.size() + found_.size());
  for (const Found& found : realigned) {
    features.push_back({.track_id = reference_.features[found.feature].track_id,
                        .at_px = found.at_px,
                        .covariance_px2 = found.covariance_px2});
  }
  for (const Found& found : found_) {
    const std::int64_t track_id = keyframe_.features[found.feature].track_id;
    const bool is_free = std::none_of(realigned.begin(), realigned.end(), [&](const Found& other) {
      return reference_.features[other.feature].track_id == track_id ||
             (other.at_px - found.at_px).norm() < min_distance_px;
    });
    if (!is_free) continue;
    features.push_back(
        {.track_id = track_id, .at_px = found.at_px, .covariance_px2 = found.covariance_px2});
  }
  std::sort(features.begin(), features.end(),
            [](const Feature& a, const Feature& b) { return a.track_id < b.track_id; });
  return features;
}

std::vector<FeatureObservation> KeyframeFeatures::observations(
    const std::vector<Feature>& features, const std::vector<Found>& found) const {
  std::vector<FeatureObservation> out;
  out.reserve(found.size());
  for (const Found& feature : found) {
    const std::optional<Eigen::Vector2d> bearing = undistort(camera_, feature.at_px.cast<double>());
    if (!bearing) continue;
    const Eigen::Matrix2d by_pixel = distort(camera_, *bearing).jacobian.inverse();
    const Eigen::Matrix2d covariance_px2 =
        kMaxErrorSigmas * kMaxErrorSigmas * feature.covariance_px2.cast<double>() +
        (lens_sigma_px_ * lens_sigma_px_ + kMinVariance_px2) * Eigen::Matrix2d::Identity();
    out.push_back({features[feature.feature].track_id, *bearing,
                   by_pixel * covariance_px2 * by_pixel.transpose()});
  }
  return out;
}

bool KeyframeFeatures::needs_keyframe(const Eigen::Quaterniond& keyframe_from_camera) const {
  constexpr double kMinFoundRatio = 0.6;
  constexpr double kMaxParallax = 0.05;  // on z = 1
  const double min_found = kMinFoundRatio * static_cast<double>(keyframe_.features.size());
  if (static_cast<double>(found_.size()) < min_found) return true;
  std::vector<double> parallaxes;
  parallaxes.reserve(found_.size());
  for (const Found& found : found_) {
    const auto now = undistort(camera_, found.at_px.cast<double>());
    const auto before = undistort(camera_, keyframe_.features[found.feature].at_px.cast<double>());
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
                       .flow_px = found.at_px - keyframe_.features[found.feature].at_px,
                       .weight = 1.0F});
  }
  return vectors;
}

}  // namespace stillkite
