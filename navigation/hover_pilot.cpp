#include "navigation/hover_pilot.hpp"

#include "navigation/motion_from_start.hpp"

namespace stillkite {
namespace {

// What is seen from a later reference, turned as the camera hung at the start: the attitude leads
// back to there, the place is the later reference's, for no length leads further.
MotionEstimate with_first_attitude(const MotionEstimate& motion,
                                   const Eigen::Quaterniond& start_from_camera) {
  const Eigen::Quaterniond start_from_reference =
      start_from_camera * motion.reference_from_camera.conjugate();
  const Eigen::Matrix3d R = start_from_reference.toRotationMatrix();
  MotionEstimate turned = motion;
  turned.reference_from_camera = start_from_camera;
  turned.rotation_covariance = R * motion.rotation_covariance * R.transpose();
  turned.displacement_in_reference = R * motion.displacement_in_reference;
  turned.displacement_covariance = R * motion.displacement_covariance * R.transpose();
  return turned;
}

}  // namespace

MotionEstimate motion_estimate(const NavigationEstimate& estimate,
                               const RigidTransform& world_from_start,
                               const RigidTransform& body_from_camera) {
  const RigidTransform start_from_camera =
      world_from_start.inverse() * (estimate.world_from_body * body_from_camera);
  const bool is_fused_without_metres =
      estimate.source == EstimateSource::fused && estimate.scale == ScaleSource::none;
  if (estimate.reference &&
      (estimate.source == EstimateSource::reference || is_fused_without_metres)) {
    const MotionEstimate& seen = estimate.reference->motion;
    return estimate.reference->is_home ? seen
                                       : with_first_attitude(seen, start_from_camera.rotation);
  }
  return motion_from_start(estimate, world_from_start, body_from_camera);
}

HoverPilot::HoverPilot(const Camera& camera, const RigidTransform& body_from_camera,
                       const NavigatorConfig& navigator, const EstimatorConfig& estimator,
                       const HoldConfig& hold, const InitialState& initial)
    : body_from_camera_(body_from_camera),
      navigator_(camera, body_from_camera, navigator, initial, estimator),
      controller_(hold) {}

PilotStep HoverPilot::step(const Frame& frame, const TetheredReadings& readings) {
  PilotStep out;
  // 1. How the camera has moved.
  out.estimate = navigator_.step(frame, readings.others);
  if (!world_from_start_) world_from_start_ = out.estimate.world_from_body * body_from_camera_;
  // 2. How it hangs in the station's frame.
  const Eigen::Quaterniond turned =
      attitude_.step(out.estimate.world_from_body.rotation, readings.others.attitude);
  const Eigen::Quaterniond station_from_body = readings.station_from_body.value_or(turned);
  // 3. The command that takes it back.
  out.decision = controller_.decide(
      {.now = readings.now,
       .estimate = motion_estimate(out.estimate, *world_from_start_, body_from_camera_),
       .tether = readings.tether,
       .station_from_camera = station_from_body * body_from_camera_.rotation});
  return out;
}

}  // namespace stillkite
