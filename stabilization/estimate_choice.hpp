#pragma once

#include <Eigen/Core>
#include <optional>

#include "estimation/motion_estimate.hpp"
#include "geometry/rigid_transform.hpp"
#include "stabilization/estimate_choice_config.hpp"

namespace stillkite {

/// Both estimates of one frame.
struct EstimatePair {
  MotionEstimate flow;       ///< from the initial camera; in metres or in initial heights
  MotionEstimate reference;  ///< from the reference frame's camera
  RigidTransform initial_from_reference;  ///< decided pose of that camera at its own frame
  std::optional<double> relief_ratio;     ///< `ground_relief` of the reference's features
  std::optional<double> misfit_ratio;     ///< their `ground_misfit` to the flow's corrected motion
  double initial_height = 1;              ///< in the flow's length unit
};

/// Selected source of a frame and the camera's pose by it.
struct EstimateDecision {
  EstimateSource source = EstimateSource::flow;
  /// With source reference: its rotation, and the flow's last translation.
  RigidTransform initial_from_camera;
  RigidTransform initial_from_flow;  ///< drift correction, left-multiplied to the flow's pose
  /// Covariance of `initial_from_flow`: (translation, rotation vector), initial camera's axes.
  Matrix6d correction_covariance = Matrix6d::Zero();
  /// Position error bound of the flow, in its unit, while the flat-ground assumption is unverified;
  /// the rotation's bound is this over the height. It is the largest displacement, or height x
  /// rotation difference to the reference, since the last verification. 0 once verified.
  double position_error_bound = 0;
};

/// Selects one of two estimates frame by frame (docs/two_view_pose.md). The flow has metric scale
/// and velocity, but assumes flat ground and drifts; the reference is free of drift and has no
/// scale.
class EstimateChoice {
 public:
  explicit EstimateChoice(const EstimateChoiceConfig& config);

  /// Keeps the last source if neither estimate is ok.
  EstimateDecision step(const EstimatePair& estimates);
  /// Multiplies all stored lengths by `factor` after a change of the flow's length unit.
  void rescale(double factor);

 private:
  void test_flat_ground(const EstimatePair& estimates);
  void update_error_bound(const EstimatePair& estimates, const RigidTransform& flow);
  [[nodiscard]] bool is_flat_or_untested() const { return is_ground_flat_.value_or(true); }
  void select(const EstimatePair& estimates);
  [[nodiscard]] bool are_consistent(const EstimatePair& estimates) const;
  void align_flow_to_reference(const EstimatePair& estimates);
  void resume_flow(const MotionEstimate& flow);
  void set_source(EstimateSource source);

  EstimateChoiceConfig config_;
  double max_squared_error_;  // normalized, of three components
  EstimateDecision decision_;
  int frames_for_other_ = 0;            // consecutive
  std::optional<bool> is_ground_flat_;  // last result of the test
  bool is_flow_confirmed_ = false;      // the features match the flow's motion over flat ground
  bool was_flow_ok_ = true;
  Eigen::Vector3d verified_position_ = Eigen::Vector3d::Zero();  // last one over flat ground
};

}  // namespace stillkite
