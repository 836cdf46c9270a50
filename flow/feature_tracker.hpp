#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/types.hpp>
#include <optional>
#include <span>
#include <vector>

#include "flow/affine_flow.hpp"
#include "flow/image_mask.hpp"
#include "flow/image_search.hpp"
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
    field("levels", self.levels, Range{1, 8}, "of the pyramid");
    field("steps", self.steps, Range{1, 30}, "Lucas-Kanade steps on the finest level");
    field("min_correlation", self.min_correlation, Range{-1, 1},
          "of a feature's window now with that in the reference, below which it is lost");
    field("forward_backward_px", self.forward_backward_px, kNotNegative,
          "a feature tracked back must end this near to where it began; 0: not tracked back");
    field("warm_start", self.warm_start, "start where the features were in the last frame");
    field("search", self.search, "search the whole image where next to no feature is found");
  }
};

/// Where the reference's features are now; entries of the reference's order.
struct FeatureTracks {
  std::vector<Eigen::Vector2f> reference_px;
  std::vector<Eigen::Vector2f> current_px;
  std::vector<unsigned char> found;  ///< 1 where `current_px` is to be believed
  /// Of `current_px`, from what the two windows differ by, as if every pixel did so on its own: of
  /// white noise that is right, errors behind JPEG are 1 to 1.6 times that (bench_feature_error).
  /// Empty where the method does not tell.
  std::vector<Eigen::Matrix2f> covariance_px2;
  int found_count = 0;
};

/// Sparse Lucas-Kanade from a fixed reference image: windows of 16x16 px about its features, in
/// every frame compared with the reference itself, so that no drift adds up. The windows are those
/// of the flow stage (TileFlow): of the reference their structure tensors are kept, not the
/// gradients, which cost less to form anew than to fetch (docs/adr/0005).
class FeatureTracker {
 public:
  explicit FeatureTracker(const FeatureTrackerConfig& config) : config_(config) {}

  /// Features whose window leaves the image are left out. The pixels are shared, not copied.
  void set_reference(const cv::Mat& grey, const std::vector<cv::Point2f>& features_px);

  /// What no image shows the world in from now on; features in it are not found.
  void set_mask(const std::shared_ptr<const ImageMask>& mask);

  /// The current image has the reference's size. The answer holds until the next call. Where the
  /// features must be searched for and it is known by how much the image has turned (from the x
  /// axis to the y axis), that is the one turn that is tried.
  const FeatureTracks& track(const cv::Mat& grey, std::optional<double> known_turn_rad = {});

 private:
  [[nodiscard]] bool is_hidden(const Eigen::Vector2f& at_px) const;
  void learn_hidden();
  void align(bool is_warm);
  [[nodiscard]] bool is_lost() const;
  void search(std::optional<double> known_turn_rad);
  bool search(std::span<const double> turns_rad);
  void start_from(const ImageShift& shift);
  void place(int level);
  void step(int level, TileWarp warp);
  void regularise(int level);
  void judge();
  void tell_covariances();
  void track_back();

  FeatureTrackerConfig config_;
  Pyramid reference_, current_;
  std::vector<TileGrid> grids_;  // one a level, one tile a feature
  std::vector<TileTextures> textures_;
  TileGrid back_grid_;
  TileTextures back_textures_;
  TilePlacement placement_;
  TileFlow tiles_;
  AffineFlow motion_;
  LocalDeformation deformation_;
  std::vector<Eigen::Matrix2f> gradients_;  // of each feature's displacement about it
  std::vector<Eigen::Vector2f> displacements_px_;
  std::vector<float> last_steps_px_;
  std::vector<float> correlations_;
  std::vector<float> noise_grey2_;    // of the windows found, in no order
  std::vector<unsigned char> alive_;  // in the level at hand
  std::shared_ptr<const ImageMask> mask_;
  std::vector<unsigned char> hidden_;  // in the reference, by the mask
  FeatureTracks tracks_;
  int last_found_count_ = 0;
  bool has_last_ = false;
};

}  // namespace stillkite
