#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "flow/frame.hpp"
#include "flow/image_mask.hpp"
#include "flow/pyramid.hpp"
#include "flow/tile_flow.hpp"

namespace stillkite {

/// Motion of a camera at rest, RMS over the image.
struct Standstill {
  double speed_px_s = 0;       ///< RMS of the last frames too: standard deviation of zero speed
  double displacement_px = 0;  ///< since the camera came to rest
};

/// Detects a camera at rest by its images alone, over any scene: most of the image has texture, and
/// its displacement stays below some tenths of a pixel (docs/inputs_and_calibration.md).
class StandstillDetector {
 public:
  /// Processes one frame. Empty unless the camera came to rest `kMinRest_s` ago.
  [[nodiscard]] std::optional<Standstill> update(const Frame& frame);

  static constexpr double kMinRest_s = 0.5;

 private:
  /// Region of the image: position in half image widths from the centre, Lucas-Kanade displacement
  /// in information form over its tiles.
  struct Region {
    double x = 0, y = 0;
    int tiles = 0;
    double gxx = 0, gxy = 0, gyy = 0, gx = 0, gy = 0;
    double residual = 0, contrast = 0, gain_product = 0;

    /// Correlation of the images, `gain`: contrast of the current over the reference.
    [[nodiscard]] double correlation(double gain) const;
  };

  using AffineVector = Eigen::Matrix<double, 6, 1>;

  /// Displacement since the camera came to rest: each component affine in the region's position.
  struct AffineDisplacement {
    AffineVector motion = AffineVector::Zero();  ///< px
    Eigen::Matrix<double, 6, 6> second_moment =
        Eigen::Matrix<double, 6, 6>::Zero();  ///< of the Jacobian over the image
    double variance_px2 = 0;                  ///< of the displacement, mean over the image

    /// RMS displacement over the image.
    [[nodiscard]] double rms_px(const AffineVector& parameters) const;
  };

  void start_at(const Frame& frame);
  void reset_grid(cv::Size size);
  void place_tiles(const Frame& frame);
  [[nodiscard]] std::optional<AffineDisplacement> displacement_at_rest(
      const TilePlacement& placement);
  [[nodiscard]] bool measure(const TilePlacement& placement);
  [[nodiscard]] std::optional<AffineDisplacement> affine_displacement() const;

  Pyramid current_, reference_;
  Timestamp rest_since_;
  struct {
    Timestamp stamp;
    AffineVector motion;
  } last_;
  double mean_speed2_ = 0;  // px^2/s^2 on the level in use
  int speeds_ = 0;
  TileGrid grid_;
  TilePlacement placement_;         // without displacement; masked tiles outside
  TilePlacement sparse_placement_;  // a quarter of them: enough to see that the camera moves
  TileTextures textures_;
  TileFlow tile_flow_;
  std::shared_ptr<const ImageMask> mask_;
  std::vector<int> region_of_tile_;
  std::vector<Region> regions_;
  double gain_ = 1;  // contrast of the current image over the reference
};

}  // namespace stillkite
