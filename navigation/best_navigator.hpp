#pragma once

#include <variant>
#include <vector>

#include "navigation/frame_interval.hpp"
#include "navigation/keyframe_navigator.hpp"
#include "navigation/paper_navigator.hpp"
#include "navigation/reference_navigator.hpp"
#include "stabilization/estimate_choice.hpp"

namespace stillkite {

/// Flow and reference estimator on the same frames; the output is selected frame by frame
/// (docs/two_view_pose.md). The reference measures no length: with it the position is held, and its
/// covariance grows.
class BestNavigator {
 public:
  BestNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                const NavigatorConfig& config, const InitialState& initial, Mode mode);

  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings);

  /// Flow vectors of the selected estimator.
  [[nodiscard]] std::vector<WeightedFlow> flow_vectors() const;

 private:
  using FlowNavigator = std::variant<KeyframeNavigator, PaperNavigator>;

  [[nodiscard]] EstimatePair pair_of(const NavigationEstimate& flow,
                                     const NavigationEstimate& reference) const;
  [[nodiscard]] NavigationEstimate answer(const NavigationEstimate& flow,
                                          const NavigationEstimate& reference) const;
  void update_scale(const NavigationEstimate& flow);
  void update_vertical(const NavigationEstimate& flow, const Eigen::Quaterniond& world_from_body);
  [[nodiscard]] GravityAlignment gravity_alignment(const Matrix6d& pose_covariance) const;

  Camera camera_;
  RigidTransform body_from_camera_;
  FlowNavigator flow_;
  ReferenceNavigator reference_;
  EstimateChoice choice_;
  EstimateDecision decision_;
  std::optional<RigidTransform> world_from_initial_;  // camera at the first frame
  RigidTransform initial_from_reference_;             // camera at the current reference frame
  RigidTransform initial_from_first_reference_;
  Eigen::Vector3d up_in_world_ = Eigen::Vector3d::UnitZ();
  double up_variance_;  // about either horizontal axis
};

}  // namespace stillkite
