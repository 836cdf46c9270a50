#pragma once

#include <memory>
#include <opencv2/core/types.hpp>
#include <optional>
#include <vector>

#include "flow/feature_tracker_config.hpp"
#include "flow/feature_tracks.hpp"
#include "flow/image_mask.hpp"
#include "flow/patch_alignment.hpp"

namespace stillkite {

/// Tracks the features of a fixed reference image from frame to frame: each frame is aligned to the
/// reference, no drift. The previous frame gives the initial displacements; once most features are
/// lost, a registration of the whole image does.
class FeatureTracker {
 public:
  explicit FeatureTracker(const FeatureTrackerConfig& config)
      : config_(config), alignment_(config) {}

  /// Removes features whose patch exceeds the image. Pixels are shared, not copied.
  void set_reference(const cv::Mat& grey, const std::vector<cv::Point2f>& features_px);

  /// Centres of the reference's patches, in the order of the features; without the removed ones.
  [[nodiscard]] const std::vector<Eigen::Vector2f>& reference_px() const {
    return alignment_.tracks().reference_px;
  }

  /// Mask for the reference and all following images; null: none. Masked features are not `found`.
  void set_mask(const std::shared_ptr<const ImageMask>& mask) { alignment_.set_mask(mask); }

  /// `grey`: CV_8UC1 of the reference's size. `image_rotation_rad`: rotation since the reference, x
  /// axis towards y axis, if known; then the only hypothesis for the registration of lost features.
  /// `expected_px`: expected flow since the previous frame. The result is valid until the next
  /// call.
  const FeatureTracks& track(const cv::Mat& grey, std::optional<double> image_rotation_rad = {},
                             const AffineFlow& expected_px = {});

  /// Aligns the features from a motion since the reference, instead of the previous frame's, and
  /// does not search. The result is valid until the next call.
  const FeatureTracks& track_from(const cv::Mat& grey, const AffineFlow& motion_px);

 private:
  [[nodiscard]] bool is_lost() const;

  FeatureTrackerConfig config_;
  PatchAlignment alignment_;
  int previous_found_count_ = 0;
  bool has_previous_ = false;
};

}  // namespace stillkite
