#include "navigation/feature_association.hpp"

#include "flow/image_mask.hpp"

namespace stillkite {
namespace {

using AssociationMethod = std::variant<FeatureTracker, OpenCvFeatureTracker, FeatureMatcher>;

AssociationMethod make_association(const ReferenceConfig& config) {
  switch (config.association) {
    case Association::windows:
      return FeatureTracker(config.windows);
    case Association::opencv:
      return OpenCvFeatureTracker(config.opencv);
    case Association::matching:
      break;
  }
  return FeatureMatcher(config.detector);
}

// Tests the feature's pixel only; FeatureTracker tests its whole patch.
void reject_masked(FeatureTracks& tracks, const ImageMask& mask) {
  const auto is_masked = [&](const Eigen::Vector2f& at_px) {
    return mask.masked_ratio(at_px.x(), at_px.y(), 1, 1) > 0;
  };
  for (std::size_t i = 0; i < tracks.found.size(); ++i) {
    if (tracks.found[i] == 0) continue;
    if (!is_masked(tracks.reference_px[i]) && !is_masked(tracks.current_px[i])) continue;
    tracks.found[i] = 0;
    --tracks.found_count;
  }
}

FeatureTracks tracks_of(const FeatureMatches& matches) {
  FeatureTracks tracks;
  for (std::size_t i = 0; i < matches.reference_px.size(); ++i) {
    tracks.reference_px.emplace_back(matches.reference_px[i].x, matches.reference_px[i].y);
    tracks.current_px.emplace_back(matches.current_px[i].x, matches.current_px[i].y);
  }
  tracks.found.assign(tracks.reference_px.size(), 1);
  tracks.found_count = static_cast<int>(tracks.found.size());
  return tracks;
}

}  // namespace

FeatureAssociation::FeatureAssociation(const ReferenceConfig& config)
    : detector_(config.detector), method_(make_association(config)) {}

bool FeatureAssociation::set_reference(const Frame& frame, int min_features,
                                       const std::vector<cv::Point2f>& tracked_px) {
  if (std::holds_alternative<FeatureMatcher>(method_)) {
    FeatureMatcher matcher(detector_);
    matcher.set_reference(frame.grey);
    if (matcher.reference_count() < min_features) return false;
    method_ = std::move(matcher);
    return true;
  }
  std::vector<cv::Point2f> features_px = tracked_px;
  const std::vector<cv::Point2f> new_px = detect_features(
      frame.grey, detector_, tracked_px, frame.mask ? frame.mask->valid_pixels() : cv::Mat());
  features_px.insert(features_px.end(), new_px.begin(), new_px.end());
  if (static_cast<int>(features_px.size()) < min_features) return false;
  if (auto* tracker = std::get_if<FeatureTracker>(&method_)) {
    tracker->set_reference(frame.grey, features_px);
  } else {
    std::get<OpenCvFeatureTracker>(method_).set_reference(frame.grey, features_px);
  }
  return true;
}

const FeatureTracks& FeatureAssociation::associate(const Frame& frame,
                                                   std::optional<double> image_rotation_rad) {
  if (auto* tracker = std::get_if<FeatureTracker>(&method_)) {
    tracker->set_mask(frame.mask);
    return tracker->track(frame.grey, image_rotation_rad);
  }
  const auto* matcher = std::get_if<FeatureMatcher>(&method_);
  tracks_ = matcher != nullptr ? tracks_of(matcher->match(frame.grey))
                               : std::get<OpenCvFeatureTracker>(method_).track(frame.grey);
  if (frame.mask) reject_masked(tracks_, *frame.mask);
  return tracks_;
}

}  // namespace stillkite
