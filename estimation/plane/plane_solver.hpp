#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimation/ego_motion/plane_motion.hpp"
#include "estimation/plane/plane_tiles.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// What is known of the plane's normal beforehand: small turns about two axes of the reference
/// camera, zero mean.
struct TiltPrior {
  TiltAxes axes = TiltAxes::Identity();
  std::optional<Eigen::Matrix2d> covariance;  ///< rad^2; nothing: the normal is known exactly
  double flow_sigma_rad = 0;  ///< smooth error of the flow that no window's residual betrays
};

struct PlaneSolverConfig {
  bool robust = true;
  double outlier_sigma = 3.0;
  int reweightings = 2;

  static void fields(auto& self, auto&& field) {
    field("robust", self.robust, "weigh down windows that do not follow the one motion");
    field("outlier_sigma", self.outlier_sigma, Range{1e-9, 1e9},
          "residual, in standard deviations, at which a window loses three quarters of its weight");
    field("reweightings", self.reweightings, Range{0, 20},
          "weighted solutions after the plain one, every Lucas-Kanade step");
  }
};

/// The windows of one pyramid level with what their Lucas-Kanade step found.
struct PlaneObservations {
  const TileJacobian& jacobian;
  const TileMeasurements& measurements;
  const std::vector<int>& cluster;  ///< neighbours whose errors are alike, 0 .. kClusters - 1
  float pixels = 0;                 ///< in a window

  static constexpr int kClusters = 48;

  /// A window is textured when its structure tensor is well above that of noise alone.
  [[nodiscard]] float textured() const { return 4.0F * pixels; }
  [[nodiscard]] float trace(std::size_t i) const {
    return measurements.gxx[i] + measurements.gyy[i];
  }
};

/// A weighted least-squares step of the plane's motion, and of its tilt where that is uncertain.
struct PlaneSolution {
  PlaneMotionStep step = PlaneMotionStep::Zero();
  PlaneMotionMatrix information = PlaneMotionMatrix::Zero();  ///< prior included
  PlaneMotionMatrix prior = PlaneMotionMatrix::Zero();
  double tilt_deflation = 1;  ///< how many times less the windows say of the tilt than it seems
  int parameters = 6;         ///< 6, or 8 with the tilt
  double noise_variance = 1;  ///< of a pixel's residual, grey^2, from the median window
  bool ok = false;            ///< false: too few textured windows, or a singular system
};

/// Iteratively reweighted least squares with Geman-McClure weights on the windows' residuals
/// against one global robust scale (the median of chi-square with two degrees of freedom).
class PlaneSolver {
 public:
  explicit PlaneSolver(const PlaneSolverConfig& config) : config_(config) {}

  /// `tilt_now`: turn of the normal from its prior so far.
  [[nodiscard]] PlaneSolution solve(const PlaneObservations& seen, const TiltPrior& tilt,
                                    const Eigen::Vector2d& tilt_now);

  /// Flow errors of neighbours are alike (relief, compression, moving water): what is independent
  /// is a cluster of windows. The sum over them of s s^T, s the gradient that the solution leaves
  /// in one (Cameron and Miller 2015, "Cluster-robust inference", eq. 11).
  [[nodiscard]] PlaneMotionMatrix scatter(const PlaneObservations& seen,
                                          const PlaneSolution& solution) const;

  [[nodiscard]] const std::vector<float>& weights() const { return weights_; }
  /// Standard deviation of a window's flow after the step, px, in the median window.
  [[nodiscard]] double residual_px(const PlaneObservations& seen);

  /// What of `residual_px` the noise does not explain: the noise is what the images differ by
  /// where each window moves as suits it best (an F-test, of medians). The windows are to have been
  /// measured with their squared residuals.
  [[nodiscard]] double deviation_px(const PlaneObservations& seen);

 private:
  PlaneSolverConfig config_;
  std::vector<float> weights_, chi2_, scratch_;
};

/// Of the solution: the sandwich A^-1 B A^-1 of its information and its scatter.
[[nodiscard]] PlaneMotionMatrix covariance_of(const PlaneSolution& solution,
                                              const PlaneMotionMatrix& scatter);

/// What the solution's motion would change by if its gradient did by the columns given.
[[nodiscard]] Eigen::Matrix<double, 6, 6> motion_by_gradient(
    const PlaneSolution& solution, const Eigen::Matrix<double, 8, 6>& gradients);

/// What the windows say by themselves, without what was known of the normal: given one normal they
/// tell the motion, and beside it how much that normal suits them. Angles of the normal are turns
/// about the tilt axes from where the solution has it.
struct WindowsAlone {
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< given it
  Eigen::Matrix<double, 6, 2> motion_by_tilt = Eigen::Matrix<double, 6, 2>::Zero();
  Eigen::Matrix2d tilt_information = Eigen::Matrix2d::Zero();      ///< W, 0 where they do not tell
  Eigen::Vector2d tilt_information_rad = Eigen::Vector2d::Zero();  ///< W times the turn
};
[[nodiscard]] WindowsAlone windows_alone(const PlaneSolution& solution,
                                         const PlaneMotionMatrix& scatter,
                                         const Eigen::Vector2d& tilt_now);

}  // namespace stillkite
