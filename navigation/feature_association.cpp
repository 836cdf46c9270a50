#include "navigation/feature_association.hpp"

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

bool FeatureAssociation::set_reference(const cv::Mat& grey, int min_features,
                                       const std::vector<cv::Point2f>& followed_px) {
  if (std::holds_alternative<FeatureMatcher>(method_)) {
    FeatureMatcher matcher(detector_);
    matcher.set_reference(grey);
    if (matcher.reference_count() < min_features) return false;
    method_ = std::move(matcher);
    return true;
  }
  std::vector<cv::Point2f> features_px = followed_px;
  const std::vector<cv::Point2f> others_px = detect_features(grey, detector_, followed_px);
  features_px.insert(features_px.end(), others_px.begin(), others_px.end());
  if (static_cast<int>(features_px.size()) < min_features) return false;
  if (auto* windows = std::get_if<FeatureTracker>(&method_)) {
    windows->set_reference(grey, features_px);
  } else {
    std::get<OpenCvFeatureTracker>(method_).set_reference(grey, features_px);
  }
  return true;
}

const FeatureTracks& FeatureAssociation::find(const cv::Mat& grey,
                                              std::optional<double> known_turn_rad) {
  if (const auto* matcher = std::get_if<FeatureMatcher>(&method_)) {
    matched_ = tracks_of(matcher->match(grey));
    return matched_;
  }
  if (auto* windows = std::get_if<FeatureTracker>(&method_)) {
    return windows->track(grey, known_turn_rad);
  }
  return std::get<OpenCvFeatureTracker>(method_).track(grey);
}

}  // namespace stillkite
