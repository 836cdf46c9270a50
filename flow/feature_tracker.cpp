#include "flow/feature_tracker.hpp"

#include "flow/feature_registration.hpp"

namespace stillkite {

void FeatureTracker::set_reference(const cv::Mat& grey,
                                   const std::vector<cv::Point2f>& features_px) {
  alignment_.set_reference(grey, features_px);
  previous_found_count_ = 0;
  has_previous_ = false;
}

const FeatureTracks& FeatureTracker::track(const cv::Mat& grey,
                                           std::optional<double> image_rotation_rad,
                                           const AffineFlow& expected_px) {
  const FeatureTracks& tracks = alignment_.tracks();
  // 1. Align from the displacements of the previous frame, else from the reference.
  alignment_.set_current(grey);
  if (has_previous_) {
    alignment_.align_from_last(expected_px);
  } else {
    alignment_.align_from(expected_px);
  }
  // 2. Most features lost, e.g. after a large motion: register the whole image.
  if (config_.search && is_lost()) register_lost_features(alignment_, image_rotation_rad);
  // 3. Still lost, e.g. by motion blur: keep the last valid motion as the next initial value.
  if (is_lost()) return tracks;
  if (tracks.found_count >= PatchAlignment::kMinMotionFeatures) {
    alignment_.fit_motion();
    has_previous_ = true;
  }
  previous_found_count_ = tracks.found_count;
  return tracks;
}

const FeatureTracks& FeatureTracker::track_from(const cv::Mat& grey, const AffineFlow& motion_px) {
  alignment_.set_current(grey);
  alignment_.align_from(motion_px);
  return alignment_.tracks();
}

// Few features found after a sudden drop.
bool FeatureTracker::is_lost() const {
  constexpr double kMinFoundRatio = 0.25;
  constexpr double kMinRemainingRatio = 0.5;
  const FeatureTracks& tracks = alignment_.tracks();
  return tracks.found_count < kMinFoundRatio * static_cast<double>(tracks.found.size()) &&
         (previous_found_count_ < PatchAlignment::kMinMotionFeatures ||
          tracks.found_count < kMinRemainingRatio * previous_found_count_);
}

}  // namespace stillkite
