#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "estimation/ego_motion/plane_motion.hpp"
#include "estimation/plane/plane_alignment_config.hpp"
#include "estimation/plane/plane_relief.hpp"
#include "estimation/plane/plane_solver.hpp"
#include "estimation/plane/plane_tiles.hpp"
#include "flow/image_mask.hpp"
#include "flow/pyramid.hpp"
#include "flow/tile_flow.hpp"
#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Rolling shutter; stamp and pose of a frame are those of its middle row. Twists: of the camera at
/// the two frames, in camera, velocities in heights/s of the reference.
struct RollingShutter {
  double readout_s = 0;  ///< first to last row; 0: global shutter
  Vector6d reference_twist = Vector6d::Zero();
  Vector6d current_twist = Vector6d::Zero();
};

/// Spatially smooth flow errors: common to many tiles, they leave no residual.
struct SmoothErrors {
  double lens_sigma_px = 0;  ///< standard deviation of the lens calibration over the image
  double relief_ratio = 0;   ///< relief of the ground over height, as ReliefFilter::ratio
};

/// Result of an alignment: motion, covariance and quality figures.
struct PlaneAlignment {
  PlaneMotion motion;                                        ///< normal corrected
  PlaneMotionMatrix covariance = PlaneMotionMatrix::Zero();  ///< cluster-robust; dt in heights
  Matrix6d smooth_covariance =
      Matrix6d::Zero();  ///< from spatially smooth flow errors; dt in heights
  Eigen::Vector2d tilt_rad =
      Eigen::Vector2d::Zero();       ///< rotation of the normal from its prior mean
  PlaneLikelihood plane_likelihood;  ///< without the tilt prior; dt in heights
  /// The same with the smooth errors that the residuals show, instead of the expected ones.
  PlaneLikelihood measured_likelihood;
  std::optional<ReliefMeasurement> relief;      ///< empty without parallax
  RollingShutter shutter;                       ///< of this alignment
  Matrix6d motion_by_twist = Matrix6d::Zero();  ///< d(motion)/d(current twist), rolling shutter

  bool solvable = false;      ///< false: too few textured tiles, motion is the initial value
  int tiles = 0;              ///< textured tiles visible in both images
  double inlier_ratio = 0;    ///< mean robust weight of these tiles
  double residual_px = 0;     ///< robust standard deviation of a tile's flow after the step
  double deviation_px = 0;    ///< part of it in excess of pixel noise, from the second level
  double mean_flow_px = 0;    ///< finest level
  double correlation = 0;     ///< normalized cross-correlation of the aligned images, -1..1
  double condition = 0;       ///< condition number of the scaled 6x6 motion information
  double ground_ratio = 0;    ///< ratio of tiles below the horizon
  double last_update_px = 0;  ///< RMS tile displacement of the last step
  double gain = 1;            ///< contrast of current over reference
};

/// Direct image alignment over a plane: Lucas-Kanade tiles in information form, Gauss-Newton on
/// SE(3) and the plane normal, coarse to fine (docs/plane_odometry.md; Baker and Matthews 2004,
/// "Lucas-Kanade 20 years on").
class PlaneAligner {
 public:
  PlaneAligner(const Camera& camera, const PlaneAlignmentConfig& config);

  /// Sets the reference; swaps `pyramid` with the previous reference to reuse its buffers.
  void set_reference(Pyramid& pyramid);
  [[nodiscard]] const Pyramid& reference() const { return reference_; }

  /// Sets the mask of static overlays in both images; nullptr: none.
  void set_mask(const std::shared_ptr<const ImageMask>& mask);

  /// Aligns `current` to the reference from the motion `initial` with the normal prior `tilt`.
  [[nodiscard]] PlaneAlignment align(const Pyramid& current, const PlaneMotion& initial,
                                     const TiltPrior& tilt, const RollingShutter& shutter = {},
                                     const SmoothErrors& smooth = {});

  /// Tiles of the finest level after the last alignment (overlay, tests).
  [[nodiscard]] const TileGrid& grid() const { return levels_.front().grid; }
  [[nodiscard]] const TilePlacement& placement() const { return placement_; }
  [[nodiscard]] const std::vector<float>& weights() const { return solver_.weights(); }

 private:
  struct Level {
    Camera camera;
    TileGrid grid;
    TileRays rays;
    std::vector<int> cluster;           ///< per tile
    std::vector<unsigned char> masked;  ///< per tile of the reference: 1 if masked
    TileTextures textures;              ///< reference image
  };

  [[nodiscard]] PlaneObservations observations(const Level& level) const;
  [[nodiscard]] const TileRays& rays_at_stamp(const Level& level, const Eigen::Vector3d& normal,
                                              const RollingShutter& shutter);
  [[nodiscard]] const TileTimes& row_times(const Camera& camera, const RollingShutter& shutter);
  [[nodiscard]] bool is_masked(const TileGrid& grid, int level, float x_px, float y_px) const;
  void reject_masked(int level);
  [[nodiscard]] float deformation_px(const TileGrid& grid) const;
  [[nodiscard]] double smooth_sigma_rad(const Level& level, const PlaneMotion& motion,
                                        const SmoothErrors& smooth) const;
  [[nodiscard]] double smooth_residual_rad(const PlaneSolution& solution) const;
  [[nodiscard]] double update_px(const Level& level, const PlaneMotionStep& step) const;
  void match_brightness(PlaneAlignment& out, bool adapt) const;
  void assess(const PlaneSolution& solution, double lens_sigma_rad, PlaneAlignment& out);
  [[nodiscard]] Matrix6d motion_by_twist(const PlaneSolution& solution);

  PlaneAlignmentConfig config_;
  Pyramid reference_;
  std::vector<Level> levels_;
  std::shared_ptr<const ImageMask> mask_;
  TileFlow tile_flow_;
  PlaneSolver solver_;
  const TileMeasurements* measurements_ = nullptr;
  TileRays rays_;    ///< rolling shutter: reference bearings at its stamp
  TileTimes times_;  ///< rolling shutter: exposure delays in the current frame
  TilePlacement placement_;
  TileJacobian jacobian_;
};

}  // namespace stillkite
