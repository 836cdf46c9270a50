#pragma once

#include <memory>
#include <vector>

#include "estimation/ego_motion/plane_motion.hpp"
#include "estimation/plane/plane_solver.hpp"
#include "estimation/plane/plane_tiles.hpp"
#include "flow/image_mask.hpp"
#include "flow/pyramid.hpp"
#include "flow/tile_flow.hpp"
#include "geometry/camera.hpp"
#include "geometry/fields.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

struct PlaneAlignmentConfig {
  int levels = 4;
  int tile_columns = 16;
  int tile_rows = 8;
  bool exact_warp = true;
  PlaneSolverConfig solver;

  static void fields(auto& self, auto&& field) {
    field("levels", self.levels, Range{1, 8}, "pyramid levels, the frame itself included");
    field("tile_columns", self.tile_columns, Range{16, 32}, "width of a window: 16 or 32 px");
    field("tile_rows", self.tile_rows, Range{8, TileGrid::kMostRows}, "height of a window");
    field("exact_warp", self.exact_warp,
          "warp every pixel exactly where a window deforms much, instead of to first order");
    field("solver", self.solver, "least squares of the windows");
  }
};

/// A camera that exposes its rows one after the other; a frame's stamp and pose are its middle
/// row's. The twists are the camera's at the two frames, velocities in heights of the reference.
struct RollingShutter {
  double readout_s = 0;  ///< from the first row to the last; 0 is a global shutter
  Vector6d reference_twist = Vector6d::Zero();
  Vector6d current_twist = Vector6d::Zero();
};

/// The motion that explains the images, and what it is worth.
struct PlaneAlignment {
  PlaneMotion motion;                                        ///< with the corrected normal
  PlaneMotionMatrix covariance = PlaneMotionMatrix::Zero();  ///< cluster-robust; dt in heights
  Matrix6d smooth_covariance = Matrix6d::Zero();  ///< by smooth errors of the flow; dt in heights
  Eigen::Vector2d tilt_rad = Eigen::Vector2d::Zero();  ///< the normal's turn from its prior
  WindowsAlone windows_alone;                          ///< without that prior; dt in heights
  RollingShutter shutter;                              ///< for which it was found
  Matrix6d motion_by_twist = Matrix6d::Zero();         ///< by a rolling shutter

  bool solvable = false;      ///< false: too little was seen, the motion is the guess
  int windows = 0;            ///< with texture, on both images
  double inlier_ratio = 0;    ///< mean weight they kept
  double residual_px = 0;     ///< robust standard deviation of a window's flow after the step
  double deviation_px = 0;    ///< of it, what noise does not explain: seen on the second level
  double mean_flow_px = 0;    ///< at the finest level
  double correlation = 0;     ///< of the aligned images, -1..1
  double condition = 0;       ///< of the scaled 6x6 information of motion
  double ground_ratio = 0;    ///< share of the windows below the horizon
  double last_update_px = 0;  ///< rms change of the windows' places in the last step
  double gain = 1;            ///< brightness of current over reference
};

/// Direct alignment of two frames of a plane: Lucas-Kanade windows in information form, placed by
/// the current motion, and Gauss-Newton on SE(3) and the plane's normal, coarse to fine
/// (docs/flow_navigator.md; Baker and Matthews 2004, "Lucas-Kanade 20 years on").
class PlaneAligner {
 public:
  PlaneAligner(const Camera& camera, const PlaneAlignmentConfig& config);

  /// What is aligned to from now on; the caller is left with the pyramid before, for its buffers.
  void set_reference(Pyramid& pyramid);
  [[nodiscard]] const Pyramid& reference() const { return reference_; }

  /// What neither image shows the world in from now on; none: nothing.
  void set_mask(const std::shared_ptr<const ImageMask>& mask);

  [[nodiscard]] PlaneAlignment align(const Pyramid& current, const PlaneMotion& guess,
                                     const TiltPrior& tilt, const RollingShutter& shutter = {});

  /// The windows of the finest level after the last alignment, for images and tests.
  [[nodiscard]] const TileGrid& grid() const { return levels_.front().grid; }
  [[nodiscard]] const TilePlacement& placement() const { return placement_; }
  [[nodiscard]] const std::vector<float>& weights() const { return solver_.weights(); }

 private:
  struct Level {
    Camera camera;
    TileGrid grid;
    TileRays rays;
    std::vector<int> cluster;           ///< of each tile
    std::vector<unsigned char> hidden;  ///< 1 where the mask hides a tile
    TileTextures textures;              ///< of the reference
  };

  [[nodiscard]] PlaneObservations observations(const Level& level) const;
  [[nodiscard]] const TileRays& rays_at_stamp(const Level& level, const Eigen::Vector3d& normal,
                                              const RollingShutter& shutter);
  [[nodiscard]] const TileTimes& times_of_rows(const Camera& camera, const RollingShutter& shutter);
  [[nodiscard]] bool is_hidden(const TileGrid& grid, int level, float x_px, float y_px) const;
  void leave_out_hidden(int level);
  [[nodiscard]] float deformation_px(const TileGrid& grid) const;
  [[nodiscard]] double update_px(const Level& level, const PlaneMotionStep& step) const;
  void match_brightness(PlaneAlignment& out, bool adapt) const;
  void assess(const PlaneSolution& solution, PlaneAlignment& out);
  [[nodiscard]] Matrix6d motion_by_twist(const PlaneSolution& solution);

  PlaneAlignmentConfig config_;
  Pyramid reference_;
  std::vector<Level> levels_;
  std::shared_ptr<const ImageMask> mask_;
  TileFlow tile_flow_;
  PlaneSolver solver_;
  const TileMeasurements* measurements_ = nullptr;
  TileRays rays_;    ///< of a rolling shutter, at the keyframe's stamp
  TileTimes times_;  ///< of a rolling shutter, in the current frame
  TilePlacement placement_;
  TileJacobian jacobian_;
};

}  // namespace stillkite
