#include "navigation/hover_pilot.hpp"

#include "flow/frame.hpp"
#include "flow/frame_copies.hpp"
#include "navigation/estimate_parts.hpp"
#include "navigation/inertial_finding.hpp"
#include "navigation/motion_conversion.hpp"
#include "navigation/pilot_step.hpp"
#include "navigation/station_attitude.hpp"
#include "stabilization/hold_controller.hpp"
#include "stabilization/hold_setpoint.hpp"

namespace stillkite {

struct HoverPilot::State {
  RigidTransform body_from_camera;
  FrameCopies copies;
  Navigator navigator;
  HoldMode mode;
  HoldController controller;
  HoldSetpoint setpoint = {};
  StationAttitude attitude;
  std::optional<Matrix6d> initial_covariance;  // of the first frame's pose
};

HoverPilot::HoverPilot(const Camera& camera, const RigidTransform& body_from_camera,
                       const NavigatorConfig& navigator, const EstimatorConfig& estimator,
                       const HoldConfig& hold, const InitialState& initial,
                       const std::optional<ImageView>& valid_pixels)
    : state_(std::make_unique<State>(
          State{.body_from_camera = body_from_camera,
                .copies = FrameCopies(camera, valid_pixels),
                .navigator = Navigator(camera, body_from_camera, navigator, initial, estimator),
                .mode = hold.mode,
                .controller = HoldController(hold)})) {}
HoverPilot::~HoverPilot() = default;
HoverPilot::HoverPilot(HoverPilot&&) noexcept = default;
HoverPilot& HoverPilot::operator=(HoverPilot&&) noexcept = default;

HoldStep HoverPilot::step(const ImageView& image, Timestamp stamp, const TetheredReadings& readings,
                          double stamp_sigma_s) {
  Frame frame = state_->copies.copy(image, stamp);
  frame.stamp_sigma_s = stamp_sigma_s;
  const PilotStep result = step(frame, readings);
  return {.estimate = public_estimate(result.estimate, state_->body_from_camera),
          .decision = result.decision};
}

PilotStep HoverPilot::step(const Frame& frame, const TetheredReadings& readings) {
  State& state = *state_;
  PilotStep out;
  // 1. Estimate the camera motion.
  out.estimate = state.navigator.step(frame, readings.sensors);
  if (!state.initial_covariance) state.initial_covariance = out.estimate.pose_covariance;
  // 2. Attitude in the station's frame.
  const Eigen::Quaterniond integrated =
      state.attitude.step(out.estimate.world_from_body.rotation, readings.sensors.attitude);
  const Eigen::Quaterniond station_from_body = readings.station_from_body.value_or(integrated);
  // 3. Displacement from the pose to hold.
  const MotionEstimate since_reference =
      motion_estimate(out.estimate, *state.initial_covariance, state.body_from_camera);
  // the paper's mean shift is relative to the reference image
  if (readings.hold_here && state.mode == HoldMode::recommended) {
    out.is_setpoint_moved = state.setpoint.move_to(since_reference);
  }
  out.motion = state.setpoint.relative(since_reference);
  // 4. Command that corrects the displacement.
  out.decision = state.controller.decide(
      {.now = readings.now,
       .estimate = out.motion,
       .tether = readings.tether,
       .station_from_camera = station_from_body * state.body_from_camera.rotation,
       .withheld = readings.withheld});
  return out;
}

std::vector<InertialFinding> HoverPilot::inertial_findings() const {
  return state_->navigator.inertial_findings();
}

std::vector<WeightedFlow> HoverPilot::flow_vectors() const {
  return state_->navigator.flow_vectors();
}

}  // namespace stillkite
