#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "flow/affine_flow.hpp"
#include "flow/feature_tracker_config.hpp"
#include "flow/feature_tracks.hpp"
#include "flow/image_mask.hpp"
#include "flow/local_deformation.hpp"
#include "flow/pyramid.hpp"
#include "flow/tile_flow.hpp"

namespace stillkite {

/// Sparse pyramidal Lucas-Kanade of an image against a fixed reference image: 16x16 px patches
/// around features, coarse to fine, from given initial displacements. Same kernel as TileFlow;
/// caches the structure tensors of the reference, not its gradients, which are cheaper to recompute
/// than to load (docs/adr/0005).
class PatchAlignment {
 public:
  /// Minimum number of features for a global motion.
  static constexpr int kMinMotionFeatures = 8;

  /// Result of an alignment.
  struct Solution {
    FeatureTracks tracks;
    std::vector<Eigen::Vector2f> displacements_px;
  };

  /// Uses levels, steps, min_correlation and forward_backward_px.
  explicit PatchAlignment(const FeatureTrackerConfig& config) : config_(config) {}

  /// As FeatureTracker::set_reference.
  void set_reference(const cv::Mat& grey, const std::vector<cv::Point2f>& features_px);

  /// As FeatureTracker::set_mask.
  void set_mask(const std::shared_ptr<const ImageMask>& mask);

  /// Image to be aligned; CV_8UC1 of the reference's size.
  void set_current(const cv::Mat& grey) { current_.build(grey, config_.levels); }

  /// Aligns all features from the displacements of a global motion.
  void align_from(const AffineFlow& motion);

  /// Aligns the features from their last displacements, those not `found` from motion(), moved by
  /// the flow that is expected since.
  void align_from_last(const AffineFlow& since);

  [[nodiscard]] const FeatureTracks& tracks() const { return tracks_; }
  /// Global motion of the last alignment, fitted on its coarse levels.
  [[nodiscard]] const AffineFlow& motion() const { return motion_; }
  /// Fits motion() to the displacements of the features found.
  void fit_motion();

  [[nodiscard]] Solution solution() const { return {tracks_, displacements_px_}; }
  void restore(Solution solution, const AffineFlow& motion);

  [[nodiscard]] const cv::Mat& reference() const { return reference_.level(0); }
  [[nodiscard]] const cv::Mat& current() const { return current_.level(0); }

 private:
  [[nodiscard]] bool is_masked(const Eigen::Vector2f& at_px) const;
  void update_masked_features();
  void align(bool is_warm);
  void place(int level);
  void step(int level, TileWarp warp);
  void replace_outliers(int level);
  void validate();
  void estimate_covariances();
  void check_forward_backward();

  FeatureTrackerConfig config_;
  Pyramid reference_, current_;
  std::vector<TileGrid> grids_;  // per level; one tile per feature
  std::vector<TileTextures> textures_;
  TileGrid backward_grid_;
  TileTextures backward_textures_;
  TilePlacement placement_;
  TileFlow tiles_;
  AffineFlow motion_;
  LocalDeformation deformation_;
  std::vector<Eigen::Matrix2f> gradients_;  // local displacement gradients
  std::vector<Eigen::Vector2f> displacements_px_;
  std::vector<float> last_step_lengths_px_;
  std::vector<float> correlations_;
  std::vector<float> noise_variances_grey2_;  // of the found features, unordered
  std::vector<unsigned char> measured_;       // on the current level
  std::shared_ptr<const ImageMask> mask_;
  std::vector<unsigned char> masked_;  // reference features under the mask
  FeatureTracks tracks_;
};

}  // namespace stillkite
