#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "estimation/ego_motion/least_squares_config.hpp"
#include "estimation/ego_motion/twist_fit.hpp"
#include "estimation/twist.hpp"
#include "estimation/verdict.hpp"
#include "flow/flow_vector.hpp"
#include "geometry/camera.hpp"
#include "geometry/plane.hpp"

namespace stillkite {

/// Twist estimated from the optical flow of one frame pair. Twist and covariance are zero unless
/// the verdict is `ok`.
struct EgoMotion {
  Verdict verdict = Verdict::too_little_texture;
  Twist twist;
  Matrix6d covariance = Matrix6d::Zero();  ///< (velocity, angular rate), camera frame
  int vectors = 0;                         ///< flow vectors with information
  double inlier_ratio = 0;
  double residual_px = 0;  ///< robust standard deviation of the flow residual, per component
  double condition = 0;    ///< of the normal matrix scaled to unit diagonal; infinite if singular
  Vector6d weakest = Vector6d::Zero();  ///< eigenvector of the smallest eigenvalue, scaled
};

/// Names of the dominant twist components of a scaled direction, largest first: "v_x, w_y".
[[nodiscard]] std::string name_direction(const Vector6d& scaled_direction);

/// Least-squares ego-motion (flow paper, step 3): minimises sum w r^T G r over the flow vectors,
/// r = flow / dt - M (v, w), M the motion field at the attitude and height of the previous frame.
class EgoMotionSolver {
 public:
  EgoMotionSolver(const Camera& camera, const LeastSquaresConfig& config);

  /// `ground`: in the previous camera frame. `dt_s` > 0: time between the frames.
  EgoMotion solve(std::span<const FlowVector> vectors, const GroundPlane& ground, double dt_s,
                  const std::optional<TwistPrior>& prior = {});

 private:
  [[nodiscard]] Verdict classify(const EgoMotion& motion) const;
  void compute_residuals(const FlowRows& rows, EgoMotion& motion);

  LeastSquaresConfig config_;
  FlowRowMaker row_maker_;
  TwistFitter fitter_;
  std::vector<double> squared_px_;
};

}  // namespace stillkite
