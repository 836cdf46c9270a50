#include "navigation/hover_pilot.hpp"

#include "navigation/motion_conversion.hpp"

namespace stillkite {
namespace {

// Motion since a later reference, in the axes of the first one. Rotation is chained to the first
// reference; the displacement stays relative to the later one, since it has no length.
MotionEstimate relative_to_first_reference(const MotionEstimate& motion,
                                           const Eigen::Quaterniond& initial_from_camera) {
  const Eigen::Quaterniond initial_from_reference =
      initial_from_camera * motion.reference_from_camera.conjugate();
  const Eigen::Matrix3d R = initial_from_reference.toRotationMatrix();
  MotionEstimate out = motion;
  out.reference_from_camera = initial_from_camera;
  out.rotation_covariance = R * motion.rotation_covariance * R.transpose();
  out.displacement_in_reference = R * motion.displacement_in_reference;
  out.displacement_covariance = R * motion.displacement_covariance * R.transpose();
  return out;
}

// The flow levels the current pose, not the initial one (index s). In initial axes, R_s^T R has the
// additional error e_s and d = R_s^T (p - p_s) the error [d]x e_s. Both are assumed independent of
// the current error, which is conservative until the flow is levelled.
MotionEstimate with_initial_pose_error(const MotionEstimate& motion,
                                       const Matrix6d& initial_covariance,
                                       const Eigen::Quaterniond& world_from_initial) {
  const Eigen::Matrix3d R = world_from_initial.conjugate().toRotationMatrix();
  const Eigen::Matrix3d rotation_covariance =
      R * initial_covariance.bottomRightCorner<3, 3>() * R.transpose();
  const Eigen::Matrix3d D = skew(motion.displacement_in_reference);
  MotionEstimate out = motion;
  out.rotation_covariance += rotation_covariance;
  out.displacement_covariance += D * rotation_covariance * D.transpose() +
                                 R * initial_covariance.topLeftCorner<3, 3>() * R.transpose();
  return out;
}

}  // namespace

MotionEstimate motion_estimate(const NavigationEstimate& estimate,
                               const Matrix6d& initial_covariance,
                               const RigidTransform& body_from_camera) {
  const RigidTransform world_from_initial = estimate.world_from_initial * body_from_camera;
  const RigidTransform initial_from_camera =
      world_from_initial.inverse() * (estimate.world_from_body * body_from_camera);
  const bool is_fused_without_scale =
      estimate.source == EstimateSource::fused && estimate.scale == ScaleSource::none;
  if (estimate.reference &&
      (estimate.source == EstimateSource::reference || is_fused_without_scale)) {
    const MotionEstimate& since_reference = estimate.reference->motion;
    return estimate.reference->on_first_reference
               ? since_reference
               : relative_to_first_reference(since_reference, initial_from_camera.rotation);
  }
  const MotionEstimate motion = motion_from_initial(estimate, world_from_initial, body_from_camera);
  // the fusion's world is fixed by the first frame: no initial pose error
  return estimate.source == EstimateSource::flow
             ? with_initial_pose_error(motion, initial_covariance, world_from_initial.rotation)
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
  // 1. Estimate the camera motion.
  out.estimate = navigator_.step(frame, readings.sensors);
  if (!initial_covariance_) initial_covariance_ = out.estimate.pose_covariance;
  // 2. Attitude in the station's frame.
  const Eigen::Quaterniond integrated =
      attitude_.step(out.estimate.world_from_body.rotation, readings.sensors.attitude);
  const Eigen::Quaterniond station_from_body = readings.station_from_body.value_or(integrated);
  // 3. Command that corrects the displacement.
  out.decision = controller_.decide(
      {.now = readings.now,
       .estimate = motion_estimate(out.estimate, *initial_covariance_, body_from_camera_),
       .tether = readings.tether,
       .station_from_camera = station_from_body * body_from_camera_.rotation});
  return out;
}

}  // namespace stillkite
