#pragma once

#include <Eigen/Core>

#include "flow/frame.hpp"
#include "navigation/estimate.hpp"
#include "navigation/navigation_estimate.hpp"
#include "navigation/sensor_update.hpp"

namespace stillkite {

/// State of the camera at one frame, by any estimator.
struct EstimateParts {
  Verdict verdict = Verdict::first_frame;
  EstimateSource source = EstimateSource::flow;
  ScaledPose camera;
  RigidTransform world_from_initial_camera;
  Twist twist_in_camera;
  Matrix6d twist_covariance = Matrix6d::Zero();
  Eigen::Vector3d velocity_in_world_m_s = Eigen::Vector3d::Zero();
  FlowQuality quality;
  bool new_keyframe = false;
};

/// Estimate of the body from the camera's state. Gravity alignment, image motion, reference report
/// and stage times are not set.
[[nodiscard]] NavigationEstimate make_estimate(const Frame& frame,
                                               const RigidTransform& body_from_camera,
                                               const EstimateParts& parts);

/// `estimate` with the image motion of `flow`, the report of `reference`, and the stage times of
/// both.
[[nodiscard]] NavigationEstimate with_both_reports(NavigationEstimate estimate,
                                                   const NavigationEstimate& flow,
                                                   const NavigationEstimate& reference);

/// Estimate for a user of the library: gravity-aligned, metric values only with a source of scale.
[[nodiscard]] Estimate public_estimate(const NavigationEstimate& estimate,
                                       const RigidTransform& body_from_camera);

}  // namespace stillkite
