#pragma once

#include <Eigen/Core>
#include <optional>

#include "estimation/motion_estimate.hpp"
#include "geometry/fields.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// When two estimates of one frame agree, and how long that has to last.
struct EstimateChoiceConfig {
  double agreement_sigmas = 3;
  double rotation_sigma_deg = 1;
  double way_sigma_ratio = 0.02;
  double max_relief_ratio = 0.2;
  int patience_frames = 10;

  static void fields(auto& self, auto&& field) {
    field("agreement_sigmas", self.agreement_sigmas, Range{0.1, 100},
          "standard deviations within which flow and reference agree");
    field("rotation_sigma_deg", self.rotation_sigma_deg, Range{0.01, 45},
          "of their rotations, beside what either claims: calibration, and the start's tilt");
    field("way_sigma_ratio", self.way_sigma_ratio, Range{1e-4, 1},
          "of the flow's way across the reference's direction, in start heights, beside what "
          "either claims");
    field("max_relief_ratio", self.max_relief_ratio, Range{0, 1},
          "of the features' parallax, what flat ground may leave unexplained");
    field("patience_frames", self.patience_frames, Range{1, 1000},
          "frames in a row that must speak for the other estimator before it is taken; one that "
          "is lost is left at once");
  }
};

/// What both estimators say of one frame.
struct EstimatePair {
  MotionEstimate flow;       ///< from the camera at the start; in metres or in start heights
  MotionEstimate reference;  ///< from the reference frame's camera
  RigidTransform start_from_reference;  ///< where that one was, as it was answered then
  std::optional<double> relief_ratio;   ///< `ground_relief` of the reference's features
  std::optional<double> misfit_ratio;   ///< their `ground_misfit` to the flow's corrected motion
  double start_height = 1;              ///< in the unit of the flow's way
};

/// Whose answer a frame's is, and where the camera is by it.
struct EstimateDecision {
  EstimateSource source = EstimateSource::flow;
  RigidTransform start_from_camera;  ///< by the reference: rotated by it, the place carried on
  RigidTransform home_from_flow;     ///< what is put before the flow's pose from the start
  /// What that adds to the flow's covariance: (translation, rotation vector), start's axes.
  Matrix6d correction_covariance = Matrix6d::Zero();
  /// By so much the flow's way may be wrong, in its unit, and its turn by as much over the height,
  /// while nothing has shown that the ground is flat: as far as it has come since that last showed,
  /// and the height times what the reference contradicts of its turn. 0 where it has shown.
  double unproven_way = 0;
};

/// Chooses one of two estimates frame by frame (docs/choice.md). The flow has metres and velocity,
/// but only over flat ground, and it drifts; the reference does not drift, but has no lengths.
class EstimateChoice {
 public:
  explicit EstimateChoice(const EstimateChoiceConfig& config) : config_(config) {}

  /// With neither estimate ok the last source stays.
  EstimateDecision step(const EstimatePair& estimates);
  /// The unit of the flow's way is so many times smaller from now on.
  void stretch(double factor);

 private:
  void judge_ground(const EstimatePair& estimates);
  void doubt(const EstimatePair& estimates, const RigidTransform& flow);
  [[nodiscard]] bool may_be_flat() const { return is_ground_flat_.value_or(true); }
  void choose(const EstimatePair& estimates);
  [[nodiscard]] bool agree(const EstimatePair& estimates) const;
  void hand_over(const EstimatePair& estimates);
  void resume_flow(const MotionEstimate& flow);
  void take(EstimateSource source);

  EstimateChoiceConfig config_;
  EstimateDecision decision_;
  int frames_for_other_ = 0;            // in a row
  std::optional<bool> is_ground_flat_;  // once the features have shown it
  bool is_flow_seen_ = false;           // they are where the flow's motion takes them
  bool was_flow_ok_ = true;
  Eigen::Vector3d proven_place_ = Eigen::Vector3d::Zero();  // where the ground was last flat
};

}  // namespace stillkite
