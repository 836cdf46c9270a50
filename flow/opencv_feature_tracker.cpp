#include "flow/opencv_feature_tracker.hpp"

#include <algorithm>
#include <opencv2/video/tracking.hpp>

namespace stillkite {

void OpenCvFeatureTracker::set_reference(const cv::Mat& grey,
                                         const std::vector<cv::Point2f>& features_px) {
  cv::buildOpticalFlowPyramid(grey, reference_pyramid_, {config_.window_px, config_.window_px},
                              config_.max_level);
  reference_px_ = features_px;
  tracks_ = {};
  for (const cv::Point2f& at : features_px) tracks_.reference_px.emplace_back(at.x, at.y);
  tracks_.current_px = tracks_.reference_px;
  tracks_.found.assign(features_px.size(), 0);
}

const FeatureTracks& OpenCvFeatureTracker::track(const cv::Mat& grey) {
  tracks_.found_count = 0;
  if (reference_px_.empty()) return tracks_;
  cv::calcOpticalFlowPyrLK(reference_pyramid_, grey, reference_px_, current_px_, status_, errors_,
                           {config_.window_px, config_.window_px}, config_.max_level);
  const cv::Rect2f image(0, 0, static_cast<float>(grey.cols - 1),
                         static_cast<float>(grey.rows - 1));
  for (std::size_t i = 0; i < reference_px_.size(); ++i) {
    tracks_.current_px[i] = {current_px_[i].x, current_px_[i].y};
    tracks_.found[i] = status_[i] != 0 && image.contains(current_px_[i]) ? 1 : 0;
    tracks_.found_count += tracks_.found[i];
  }
  return tracks_;
}

}  // namespace stillkite
