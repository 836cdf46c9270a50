#pragma once

#include <variant>
#include <vector>

#include "navigation/frame_interval.hpp"
#include "navigation/keyframe_navigator.hpp"
#include "navigation/paper_navigator.hpp"
#include "navigation/reference_navigator.hpp"
#include "stabilization/estimate_choice.hpp"

namespace stillkite {

/// Both estimators on the same frames, and of each frame the answer of one (docs/choice.md). By
/// the reference a row knows no lengths: its place is carried on, with a covariance that says so.
class BestNavigator {
 public:
  BestNavigator(const Camera& camera, const RigidTransform& body_from_camera,
                const NavigatorConfig& config, const InitialState& initial, Mode mode);

  NavigationEstimate step(const Frame& frame, const FrameInterval& interval,
                          const SensorReadings& readings);

  /// Of the estimator that was chosen.
  [[nodiscard]] std::vector<WindowFlow> windows() const;

 private:
  using FlowNavigator = std::variant<KeyframeNavigator, PaperNavigator>;

  [[nodiscard]] EstimatePair pair_of(const NavigationEstimate& flow,
                                     const NavigationEstimate& reference) const;
  [[nodiscard]] NavigationEstimate answer(const NavigationEstimate& flow,
                                          const NavigationEstimate& reference) const;
  void take_unit(const NavigationEstimate& flow);
  void take_up(const NavigationEstimate& flow, const Eigen::Quaterniond& world_from_body);
  [[nodiscard]] GravityAlignment upright(const Matrix6d& pose_covariance) const;

  Camera camera_;
  RigidTransform body_from_camera_;
  FlowNavigator flow_;
  ReferenceNavigator reference_;
  EstimateChoice choice_;
  EstimateDecision decision_;
  std::optional<RigidTransform> world_from_start_;  // the camera at the first frame
  RigidTransform start_from_reference_;             // where the reference frame's camera was
  RigidTransform start_from_home_;                  // that of the first one
  Eigen::Vector3d up_in_world_ = Eigen::Vector3d::UnitZ();
  double up_variance_;  // about either level axis
};

}  // namespace stillkite
