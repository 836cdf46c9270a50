#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/types.hpp>
#include <optional>
#include <span>
#include <vector>

#include "flow/affine_flow.hpp"
#include "flow/image_mask.hpp"
#include "flow/image_registration.hpp"
#include "flow/local_deformation.hpp"
#include "flow/pyramid.hpp"
#include "flow/tile_flow.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

struct FeatureTrackerConfig {
  int levels = 4;
  int steps = 4;
  double min_correlation = 0.7;
  double forward_backward_px = 0.5;
  bool warm_start = true;
  bool search = true;

  static void fields(auto& self, auto&& field) {
    field("levels", self.levels, Range{1, 8}, "number of pyramid levels");
    field("steps", self.steps, Range{1, 30}, "Lucas-Kanade iterations on the finest level");
    field("min_correlation", self.min_correlation, Range{-1, 1},
          "minimum normalized correlation of a feature's patch with its reference patch");
    field("forward_backward_px", self.forward_backward_px, kNonNegative,
          "maximum forward-backward error; 0: no forward-backward check");
    field("warm_start", self.warm_start, "initialize the displacements from the previous frame");
    field("search", self.search, "register the whole image when most features are lost");
  }
};

/// Positions of the reference features in the current image, in the order of the reference.
struct FeatureTracks {
  std::vector<Eigen::Vector2f> reference_px;
  std::vector<Eigen::Vector2f> current_px;
  std::vector<unsigned char> found;  ///< 1 where `current_px` is valid
  /// Covariance of `current_px` from the patch residual under white pixel noise. Optimistic after
  /// JPEG: errors are 1 to 1.6 sigma (bench_feature_error). Empty if the method has no covariance.
  std::vector<Eigen::Matrix2f> covariance_px2;
  int found_count = 0;
};

/// Sparse pyramidal Lucas-Kanade against a fixed reference image: 16x16 px patches, no drift.
/// Same kernel as TileFlow; caches the structure tensors of the reference, not its gradients, which
/// are cheaper to recompute than to load (docs/adr/0005).
class FeatureTracker {
 public:
  explicit FeatureTracker(const FeatureTrackerConfig& config) : config_(config) {}

  /// Removes features whose patch exceeds the image. Pixels are shared, not copied.
  void set_reference(const cv::Mat& grey, const std::vector<cv::Point2f>& features_px);

  /// Mask for the reference and all following images; null: none. Masked features are not `found`.
  void set_mask(const std::shared_ptr<const ImageMask>& mask);

  /// `grey`: CV_8UC1 of the reference's size. `image_rotation_rad`: rotation since the reference, x
  /// axis towards y axis, if known; then the only hypothesis for the registration of lost features.
  /// The result is valid until the next call.
  const FeatureTracks& track(const cv::Mat& grey, std::optional<double> image_rotation_rad = {});

 private:
  [[nodiscard]] bool is_masked(const Eigen::Vector2f& at_px) const;
  void update_masked_features();
  void align(bool is_warm);
  [[nodiscard]] bool is_lost() const;
  void register_reference(std::optional<double> image_rotation_rad);
  bool register_reference(std::span<const double> rotations_rad);
  void initialize_from(const ImageRegistration& registration);
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
  int previous_found_count_ = 0;
  bool has_previous_ = false;
};

}  // namespace stillkite
