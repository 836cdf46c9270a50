#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "estimation/fusion/start_prior.hpp"

namespace stillkite {

/// A feature of the first reference that may become a landmark.
struct StartCandidate {
  FeatureView reference;  ///< as the anchor sees it
  double guess = 0;       ///< of its inverse depth, 1 / map units
};

/// Guesses tell one start from another. Then they are told to be off by this many times more: a
/// hundred of them would draw far points near, where a short way tells little, and turn the camera.
inline constexpr double kVagueness = 2;

/// Where points are, the first so many of the candidates, and the camera in the chosen frames.
struct StartEstimate {
  struct Point {
    Eigen::Vector2d bearing;  ///< on z = 1 of the anchor
    double inverse_depth = 0;
    RunningRatio stray;
    int views = 0;  ///< that told how it strays
  };
  std::vector<Point> points;
  std::vector<RigidTransform> world_from_camera;
  /// Sigma of a guessed depth, over `inverse_depth_sigma_ratio`.
  double vagueness = 1;
  /// -2 log likelihood of the views, but for what estimates of the same points share.
  double cost = HUGE_VAL;
  /// Squared length of the last step, in its sigmas.
  double step = HUGE_VAL;
};

/// What the first images of a hover tell as a whole: Gauss and Newton's steps on points and poses
/// together, the points eliminated (bundle adjustment: Triggs et al. 2000, section 6.1). The prior
/// of the poses is what all other sensors tell; what windows are off by in the reference is taken
/// to last.
class StartBundle {
 public:
  /// The anchor is the camera at the end of a frame. The chosen frames, in order, have views; those
  /// of no candidates are left out.
  StartBundle(const FusionConfig& config, StartPrior prior, std::size_t anchor,
              std::span<const ToldFrame> frames, const std::vector<std::size_t>& chosen,
              std::vector<StartCandidate> candidates);

  /// Points of these inverse depths, and the poses that they tell.
  [[nodiscard]] StartEstimate begin(const std::vector<double>& inverse_depths) const;
  /// Where a point cannot be seen from where it is said to be, or nothing can be solved, the cost
  /// is infinite.
  void step(StartEstimate& estimate) const;
  /// The candidates that are no points yet, as they are guessed. False: there are none. Guesses
  /// are vaguer from here on.
  bool add_rest(StartEstimate& estimate) const;
  /// Points that are off by more than others of their frames weigh less from here on.
  void weigh(StartEstimate& estimate) const;
  /// The camera in all frames.
  [[nodiscard]] std::vector<RigidTransform> way(const StartEstimate& estimate) const;

  [[nodiscard]] const std::vector<StartCandidate>& candidates() const { return candidates_; }
  [[nodiscard]] const RigidTransform& world_from_anchor() const { return world_from_anchor_; }

 private:
  struct View {
    std::size_t frame;  // among the chosen ones
    Eigen::Vector2d bearing;
    Eigen::Matrix2d covariance;
  };
  struct Equations;
  [[nodiscard]] Equations equations(const StartEstimate& estimate) const;
  [[nodiscard]] RigidTransform resected(std::size_t frame,
                                        const std::vector<StartEstimate::Point>& points) const;
  [[nodiscard]] Eigen::Matrix2d usual_covariance(const View& view, const StartEstimate& estimate,
                                                 std::size_t point) const;
  // of the prior's mean from the estimate
  [[nodiscard]] Eigen::VectorXd prior_error(const StartEstimate& estimate) const;

  FusionConfig config_;
  StartPrior prior_;
  RigidTransform world_from_anchor_;
  std::vector<std::size_t> chosen_;
  std::vector<StartCandidate> candidates_;
  std::vector<std::vector<View>> views_;  // of each candidate
  Eigen::MatrixXd prior_root_;            // L of the chosen poses' covariance L L^T
  bool is_prior_sound_ = false;
};

}  // namespace stillkite
