#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "estimation/ego_motion/least_squares_config.hpp"
#include "estimation/ego_motion/twist_fit.hpp"
#include "estimation/twist.hpp"
#include "estimation/verdict.hpp"
#include "flow/flow_window.hpp"
#include "geometry/camera.hpp"
#include "geometry/plane.hpp"

namespace stillkite {

/// The twist that explains one frame pair's flow. Twist and covariance are zero unless the
/// verdict is `ok`.
struct EgoMotion {
  Verdict verdict = Verdict::too_little_texture;
  Twist twist;
  Matrix6d covariance = Matrix6d::Zero();  ///< (velocity, angular rate), camera frame
  int windows = 0;                         ///< that carried information
  double inlier_ratio = 0;
  double residual_px = 0;  ///< robust standard deviation of flow minus motion, a component
  double condition = 0;    ///< of the normal matrix scaled to unit diagonal; infinite if singular
  Vector6d weakest = Vector6d::Zero();  ///< its weakest eigenvector, in the scaled coordinates
};

/// The twist's components that make up a scaled direction, the largest first: "v_x, w_y".
[[nodiscard]] std::string name_direction(const Vector6d& scaled_direction);

/// Step 3 of the flow paper's procedure: minimises sum w r^T G r over the windows, with
/// r = flow / dt - M (v, w), M the motion field at the attitude and height of the previous frame.
class EgoMotionSolver {
 public:
  EgoMotionSolver(const Camera& camera, const LeastSquaresConfig& config);

  /// `ground` as the previous frame saw it; dt_s > 0 between the two frames.
  EgoMotion solve(std::span<const FlowWindow> windows, const GroundPlane& ground, double dt_s,
                  const std::optional<TwistPrior>& prior = {});

 private:
  [[nodiscard]] Verdict judge(const EgoMotion& motion) const;
  void measure_residuals(const FlowRows& rows, EgoMotion& motion);

  LeastSquaresConfig config_;
  FlowRowMaker row_maker_;
  TwistFitter fitter_;
  std::vector<double> squared_px_;
};

}  // namespace stillkite
