#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
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

  /// Features of a new keyframe, by ascending number of the track.
  struct Keyframe {
    std::vector<FeatureObservation> features;
    /// Those of the reference keyframe, by its image.
    std::vector<FeatureObservation> realigned;
  };
  /// Makes the image that was tracked last the keyframe: its features and newly detected ones.
  /// Empty, and the keyframe stays, if they are fewer than 20. `expected`: features of the
  /// reference keyframe; they are aligned to its image, so that errors do not add up while they are
  /// in view.
  [[nodiscard]] Keyframe take_keyframe(const Frame& frame,
                                       std::span<const ExpectedFeature> expected = {});

  /// Makes the latest keyframe the reference keyframe.
  void keep_as_reference() {
    is_reference_ = true;
    reference_ = {};
  }

  /// Keeps the reference keyframe apart, to search for it in later images.
  void lose_reference() { lost_ = is_reference_ ? keyframe_ : reference_; }
  /// Features of the lost reference keyframe in an image, by ascending number of the track;
  /// searches the whole image.
  [[nodiscard]] std::vector<FeatureObservation> search_lost(const Frame& frame);
  void forget_lost() { lost_ = {}; }

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

  // Features of a keyframe with their patches.
  struct Patches {
    FeatureTracker tracker{FeatureTrackerConfig{}};
    std::vector<Feature> features;
  };

  [[nodiscard]] std::vector<FeatureObservation> observations(const std::vector<Feature>& features,
                                                             const std::vector<Found>& found) const;
  [[nodiscard]] std::vector<Found> realign(const Frame& frame,
                                           std::span<const ExpectedFeature> expected);
  [[nodiscard]] std::vector<Feature> continued_features(const std::vector<Found>& realigned) const;
  [[nodiscard]] static std::vector<Found> found_in(const std::vector<Feature>& features,
                                                   const FeatureTracks& tracks);
  [[nodiscard]] AffineFlow expected_flow_px(Timestamp stamp) const;
  void update_flow(Timestamp stamp);

  Camera camera_;
  DetectorConfig detector_;
  double lens_sigma_px_;
  Patches keyframe_;
  Patches reference_;            // empty if it is the latest keyframe
  bool is_reference_ = false;    // the latest keyframe
  Patches lost_;                 // of the reference keyframe before
  std::vector<Found> found_;     // in the last image
  std::vector<Found> previous_;  // in the image before
  AffineFlow flow_px_;           // of the last interval
  double interval_s_ = 0;
  Timestamp last_;
  std::int64_t next_track_id_ = 0;
};

}  // namespace stillkite
