#include "simulation/hover/hover_trial.hpp"

#include "geometry/euler.hpp"
#include "navigation/hover_pilot.hpp"
#include "navigation/pilot_step.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/hover/fault_effects.hpp"
#include "simulation/hover/hover_streams.hpp"
#include "simulation/hover/hover_video.hpp"
#include "simulation/hover/sensor_buffer.hpp"

namespace stillkite {
namespace {

// True initial position, and the initial state of the estimator.
struct TrialStart {
  Eigen::Vector3d position_in_world_m;
  InitialState estimate;
};

TrialStart make_start(const RigidTransform& world_from_body, double measured_height_m) {
  return {.position_in_world_m = world_from_body.translation,
          .estimate = {.world_from_body = {world_from_body.rotation, {0, 0, measured_height_m}},
                       .scale = ScaleSource::initial_height}};
}

RigidTransform gimbal(const HoverConfig& config) {
  return camera_raised_forward(config.plant.camera.forward_tilt_deg);
}

HoverPilot make_pilot(const TrialStart& start, const HoverConfig& config) {
  return {config.plant.camera.lens(), gimbal(config), config.navigator,
          config.estimator,           config.hold,    start.estimate};
}

EstimateError error_of(const NavigationEstimate& estimate, const TrialStart& start,
                       const HoverConfig& config, const DroneTruth& truth) {
  const RigidTransform world_from_estimate{
      .rotation = Eigen::Quaterniond::Identity(),
      .translation = start.position_in_world_m - start.estimate.world_from_body.translation};
  return estimate_error(estimate, gimbal(config), world_from_estimate,
                        {truth.world_from_camera, truth.velocity_in_world_m_s});
}

TrialSample sample_of(const HoverPlant& plant, const Eigen::Vector3d& start_in_world_m,
                      const PilotStep& latest) {
  const RigidTransform& drone = plant.truth().world_from_body;
  TrialSample sample;
  sample.t_s = to_seconds(plant.now());
  sample.drone_in_world_m = drone.translation;
  sample.displacement_in_world_m = drone.translation - start_in_world_m;
  sample.station_in_world_m = plant.world_from_station().translation;
  sample.yaw_rad = to_euler(drone.rotation).yaw_rad;
  sample.action = latest.decision.action;
  sample.reason = latest.decision.reason;
  sample.verdict = latest.estimate.verdict;
  sample.command = latest.decision.command;
  return sample;
}

}  // namespace

std::vector<Trial> make_trials(const HoverConfig& config) {
  Random seeds = hover_random(static_cast<std::uint64_t>(config.seed), HoverStream::trials);
  std::vector<Trial> trials;
  for (const auto& [axis, name] : EnumNames<PaperAxis>::value) {
    for (int i = 0; i < config.trials.on + config.trials.off; ++i) {
      trials.push_back(
          {.axis = axis, .stabilized = i < config.trials.on, .seed = seeds.bits() >> 11});
    }
  }
  return trials;
}

TrialRecord fly_trial(const HoverConfig& config, const HoverWorld& world, const Trial& trial,
                      const TrialObserver& observer) {
  HoverPlant plant(config, trial);
  HoverSensors sensors(config.plant.sensors,
                       hover_random(trial.seed, HoverStream::trial_sensors).bits());
  HoverVideo video(config, world, trial);
  SensorBuffer buffer(plant.world_from_station().rotation.conjugate());
  const RigidTransform& drone = plant.truth().world_from_body;
  const TrialStart start = make_start(drone, sensors.measured_height_m(drone.translation.z()));
  HoverPilot pilot = make_pilot(start, config);
  TrialRecord record{.trial = trial, .samples = {}, .kicks = plant.kicks(), .estimate_errors = {}};
  for (PilotStep last; !plant.is_over(); plant.step(last.decision.command)) {
    const Timestamp now = plant.now();
    // 1. Sensor readings and exposure.
    buffer.add(with_fault(sensors.read(plant.truth(), now), plant.fault()));
    const bool is_exposed = video.expose(plant.truth(), buffer.attitude(), now, plant.fault());
    // 2. Estimate and command from a received image; error of the estimate.
    if (const std::optional<SentImage> sent = video.receive(now)) {
      last = pilot.step(sent->frame, buffer.readings(sent->frame.stamp, sent->attitude, now));
      if (!trial.stabilized) last.decision = {};
      record.estimate_errors.push_back(error_of(last.estimate, start, config, sent->truth));
      if (observer) observer(sent->frame, last.estimate, last.decision);
    }
    // 3. Ground truth, one sample per exposure.
    if (is_exposed) record.samples.push_back(sample_of(plant, start.position_in_world_m, last));
  }
  return record;
}

}  // namespace stillkite
