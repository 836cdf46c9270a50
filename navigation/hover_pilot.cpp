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

// The flow levels itself, not the start: seen from there, R_s^T R and d = R_s^T (p - p_s) err by
// e_s, the start's own error in its own axes, and by [d]x e_s. Taken as independent of the error
// now, which errs to the careful side until the flow is levelled.
MotionEstimate with_error_of_start(const MotionEstimate& motion, const Matrix6d& start_covariance,
                                   const Eigen::Quaterniond& world_from_start) {
  const Eigen::Matrix3d R = world_from_start.conjugate().toRotationMatrix();
  const Eigen::Matrix3d turn = R * start_covariance.bottomRightCorner<3, 3>() * R.transpose();
  const Eigen::Matrix3d D = skew(motion.displacement_in_reference);
  MotionEstimate out = motion;
  out.rotation_covariance += turn;
  out.displacement_covariance +=
      D * turn * D.transpose() + R * start_covariance.topLeftCorner<3, 3>() * R.transpose();
  return out;
}

}  // namespace

MotionEstimate motion_estimate(const NavigationEstimate& estimate, const Matrix6d& start_covariance,
                               const RigidTransform& body_from_camera) {
  const RigidTransform world_from_start = estimate.world_from_start * body_from_camera;
  const RigidTransform start_from_camera =
      world_from_start.inverse() * (estimate.world_from_body * body_from_camera);
  const bool is_fused_without_metres =
      estimate.source == EstimateSource::fused && estimate.scale == ScaleSource::none;
  if (estimate.reference &&
      (estimate.source == EstimateSource::reference || is_fused_without_metres)) {
    const MotionEstimate& seen = estimate.reference->motion;
    return estimate.reference->on_first_reference
               ? seen
               : with_first_attitude(seen, start_from_camera.rotation);
  }
  const MotionEstimate motion = motion_from_start(estimate, world_from_start, body_from_camera);
  // the fusion's world is that of the first frame, whose pose in it is exact
  return estimate.source == EstimateSource::flow
             ? with_error_of_start(motion, start_covariance, world_from_start.rotation)
             : motion;
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
  if (!start_covariance_) start_covariance_ = out.estimate.pose_covariance;
  // 2. How it hangs in the station's frame.
  const Eigen::Quaterniond turned =
      attitude_.step(out.estimate.world_from_body.rotation, readings.others.attitude);
  const Eigen::Quaterniond station_from_body = readings.station_from_body.value_or(turned);
  // 3. The command that takes it back.
  out.decision = controller_.decide(
      {.now = readings.now,
       .estimate = motion_estimate(out.estimate, *start_covariance_, body_from_camera_),
       .tether = readings.tether,
       .station_from_camera = station_from_body * body_from_camera_.rotation});
  return out;
}

}  // namespace stillkite
