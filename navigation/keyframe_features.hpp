#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "estimation/sliding_window/sliding_window.hpp"
#include "flow/affine_flow.hpp"
#include "flow/detector_config.hpp"
#include "flow/feature_tracker.hpp"
#include "flow/frame.hpp"
#include "geometry/camera.hpp"
#include "navigation/weighted_flow.hpp"

namespace stillkite {

/// Features of the sliding window. Every image is aligned to the latest keyframe's image, so that
/// errors do not add up from frame to frame; a track lives across keyframes.
class KeyframeFeatures {
 public:
  /// `lens_sigma_px`: error of the calibration, independent from feature to feature.
  KeyframeFeatures(const Camera& camera, double lens_sigma_px);

  /// Features of the latest keyframe in an image, by ascending number of the track.
  [[nodiscard]] std::vector<FeatureObservation> track(const Frame& frame);

  /// Makes the image that was tracked last the keyframe: its features and newly detected ones, by
  /// ascending number of the track. Empty, and the keyframe stays, if they are fewer than 20.
  [[nodiscard]] std::vector<FeatureObservation> take_keyframe(const Frame& frame);

  /// True if few features are left, or the median parallax since the keyframe exceeds 3 degrees.
  /// `keyframe_from_camera`: rotation since the keyframe.
  [[nodiscard]] bool needs_keyframe(const Eigen::Quaterniond& keyframe_from_camera) const;

  [[nodiscard]] int found_count() const { return static_cast<int>(found_.size()); }
  /// Displacements since the keyframe, for drawing.
  [[nodiscard]] std::vector<WeightedFlow> flow_vectors() const;

 private:
  // Feature of the keyframe: the tracker follows the centre of its patch.
  struct Feature {
    std::int64_t track_id;
    Eigen::Vector2f at_px;
    Eigen::Vector2f patch_px = Eigen::Vector2f::Zero();
    /// Of `at_px`, by the alignments to earlier keyframes: all images of this keyframe share it.
    Eigen::Matrix2f covariance_px2 = Eigen::Matrix2f::Zero();
  };
  struct Found {
    std::size_t feature;
    Eigen::Vector2f at_px;
    Eigen::Matrix2f covariance_px2;
  };

  [[nodiscard]] std::vector<FeatureObservation> observations(const std::vector<Found>& found) const;
  [[nodiscard]] AffineFlow expected_flow_px(Timestamp stamp) const;
  void update_flow(Timestamp stamp);

  Camera camera_;
  DetectorConfig detector_;
  double lens_sigma_px_;
  FeatureTracker tracker_;
  std::vector<Feature> features_;
  std::vector<Found> found_;     // in the last image
  std::vector<Found> previous_;  // in the image before
  AffineFlow flow_px_;           // of the last interval
  double interval_s_ = 0;
  Timestamp last_;
  std::int64_t next_track_id_ = 0;
};

}  // namespace stillkite
