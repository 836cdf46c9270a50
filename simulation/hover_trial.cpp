#include "simulation/hover_trial.hpp"

#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "geometry/euler.hpp"
#include "navigation/hover_pilot.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/coast_scene.hpp"
#include "simulation/develop.hpp"
#include "simulation/random.hpp"
#include "simulation/room_scene.hpp"

namespace stillkite {
namespace {

// Divides the periods of 30 Hz, 50 Hz and 200 Hz.
constexpr std::int64_t kStepsPerSecond = 600;
constexpr double kStep_s = 1.0 / kStepsPerSecond;

enum HoverStream : std::uint64_t {
  kScene = 1,
  kTrials,
  kTrialSensors,
  kTrialWind,
  kTrialKicks,
  kPixels
};

Timestamp stamp_of_step(std::int64_t step) {
  return from_seconds(static_cast<double>(step) / kStepsPerSecond);
}

/// The physical side of a trial: what happens whether or not anyone looks.
class TrialPlant {
 public:
  TrialPlant(const HoverConfig& config, const Trial& trial)
      : path_(config.plant.station),
        wind_(config.plant.wind, Random(trial.seed, kTrialWind).bits()),
        drone_(config.plant.drone, camera_raised_forward(config.plant.camera.forward_tilt_deg),
               station(trial.axis, 0), 0) {
    if (config.plant.yaw_kicks) {
      kicks_ = make_yaw_kicks(*config.plant.yaw_kicks, duration_s(),
                              Random(trial.seed, kTrialKicks).bits());
    }
  }

  [[nodiscard]] double duration_s() const { return station_duration_s(path_); }
  [[nodiscard]] const DroneTruth& truth() const { return drone_.truth(); }
  [[nodiscard]] const std::vector<YawKick>& kicks() const { return kicks_; }
  [[nodiscard]] RigidTransform world_from_station(double t_s) const {
    return station_at(path_, t_s).world_from_station;
  }

  // One step's `to_s` is the next one's `from_s` to the last bit: what happens at an instant
  // happens once.
  void step(double from_s, double to_s, const TetherCommand& command) {
    wind_.step(kStep_s);
    drone_.step(command,
                {.wind_in_world_m_s = wind_.in_world_m_s(),
                 .yaw_kick_rad = kicked_between_rad(kicks_, from_s, to_s)},
                station_at(path_, to_s), kStep_s);
  }

 private:
  [[nodiscard]] StationState station(PaperAxis axis, double t_s) {
    path_.axis = axis;
    return station_at(path_, t_s);
  }

  StationPathConfig path_;
  DrydenWind wind_;
  TetheredDrone drone_;
  std::vector<YawKick> kicks_;
};

/// The controller's side of the sensors: what has arrived.
class Inbox {
 public:
  void take(const HoverReadings& readings) {
    for (const TetherSample& sample : readings.tether) tether_.push_back(sample);
    for (const AttitudeReading& reading : readings.attitude) {
      attitude_ = reading.world_from_body;
      inertial_.push_back(
          {reading.stamp, reading.angular_rate_in_body_rad_s, reading.specific_force_in_body_m_s2});
    }
  }
  [[nodiscard]] std::optional<TetherReading> latest_tether(Timestamp now) {
    while (tether_.size() > 1 && tether_[1].available <= now) tether_.pop_front();
    if (tether_.empty() || tether_.front().available > now) return std::nullopt;
    const TetherSample& latest = tether_.front();
    return TetherReading{latest.stamp, latest.tether, latest.taut};
  }
  /// With the picture of this instant, which the IMU stamps.
  [[nodiscard]] const Eigen::Quaterniond& attitude() const { return attitude_; }
  /// Those up to then that have not been taken yet.
  [[nodiscard]] std::vector<InertialReading> take_inertial(Timestamp until) {
    std::vector<InertialReading> taken;
    while (!inertial_.empty() && inertial_.front().stamp <= until) {
      taken.push_back(inertial_.front());
      inertial_.pop_front();
    }
    return taken;
  }

 private:
  std::deque<TetherSample> tether_;
  std::deque<InertialReading> inertial_;
  Eigen::Quaterniond attitude_ = Eigen::Quaterniond::Identity();
};

/// A picture on its way to a command.
struct PendingFrame {
  Timestamp due;
  Frame frame;
  Eigen::Quaterniond attitude;
};

// The camera moves evenly while the shutter is open, the exposure's stamp in the middle.
Shutter shutter_about(const DroneTruth& truth, const SimulatedCameraConfig& camera) {
  const auto at = [&](double from_now_s) {
    const Eigen::Vector3d turn(0, 0, truth.yaw_rate_rad_s * from_now_s);
    return RigidTransform{
        so3_exp(turn) * truth.world_from_camera.rotation,
        truth.world_from_camera.translation + truth.velocity_in_world_m_s * from_now_s};
  };
  return {.world_from_camera_at_opening = at(-0.5 * camera.shutter_s),
          .world_from_camera_at_closing = at(0.5 * camera.shutter_s),
          .instants = camera.shutter_s > 0 ? camera.shutter_samples : 1};
}

Frame expose(const HoverConfig& config, const HoverWorld& world, const TrialPlant& plant,
             std::uint64_t seed, Timestamp now, std::int64_t index) {
  const cv::Mat light =
      world.renderer.render(world.scene, shutter_about(plant.truth(), config.plant.camera));
  const cv::Mat grey = develop(light, {.noise_grey = config.plant.camera.noise_grey},
                               Random(seed, kPixels).bits() + static_cast<std::uint64_t>(index));
  return {.stamp = now, .index = index, .grey = world.link ? world.link(grey) : grey};
}

TrialSample sample_of(const TrialPlant& plant, double t_s,
                      const Eigen::Vector3d& start_in_world_m) {
  const RigidTransform& drone = plant.truth().world_from_body;
  TrialSample sample;
  sample.t_s = t_s;
  sample.drone_in_world_m = drone.translation;
  sample.displacement_in_world_m = drone.translation - start_in_world_m;
  sample.station_in_world_m = plant.world_from_station(t_s).translation;
  sample.yaw_rad = to_euler(drone.rotation).yaw_rad;
  return sample;
}

}  // namespace

HoverWorld make_hover_world(const HoverConfig& config, VideoLink link) {
  const std::uint64_t seed = Random(static_cast<std::uint64_t>(config.seed), kScene).bits();
  return {config.scene == SceneKind::room ? make_room(seed) : make_coast(seed),
          PatchRenderer(config.plant.camera.lens(), config.plant.camera.supersampling),
          std::move(link)};
}

std::vector<Trial> make_trials(const HoverConfig& config) {
  Random seeds(static_cast<std::uint64_t>(config.seed), kTrials);
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
  const SimulatedCameraConfig& camera = config.plant.camera;
  const RigidTransform body_from_camera = camera_raised_forward(camera.forward_tilt_deg);
  TrialPlant plant(config, trial);
  HoverSensors sensors(config.plant.sensors, Random(trial.seed, kTrialSensors).bits());
  const RigidTransform start = plant.truth().world_from_body;
  // at take-off the drone stands on its station: their headings are known to each other
  const Eigen::Quaterniond station_from_world = plant.world_from_station(0).rotation.conjugate();
  HoverPilot pilot(
      camera.lens(), body_from_camera, config.navigator, config.estimator, config.hold,
      {.world_from_body = {start.rotation, {0, 0, sensors.known_height_m(start.translation.z())}},
       .scale = ScaleSource::initial_height});

  TrialRecord record{.trial = trial, .samples = {}, .kicks = plant.kicks()};
  Inbox inbox;
  std::deque<PendingFrame> pending;
  PilotStep last;
  std::int64_t frames = 0;
  std::int64_t looks = 0;
  const auto steps = static_cast<std::int64_t>(std::ceil(plant.duration_s() * kStepsPerSecond));
  for (std::int64_t step = 0; step <= steps; ++step) {
    const Timestamp now = stamp_of_step(step);
    const double t_s = to_seconds(now);
    // 1. What the sensors measure, and what the camera sees.
    inbox.take(sensors.read(plant.truth(), now));
    const bool is_exposed = t_s >= static_cast<double>(frames) / camera.frames_per_s - 1e-9;
    const bool is_looked_at = is_exposed && trial.stabilized &&
                              t_s >= static_cast<double>(looks) * config.cycle.period_s - 1e-9;
    if (is_looked_at) {
      ++looks;
      const double delay_s = config.plant.camera_latency_s + config.cycle.compute_s;
      pending.push_back({{now.ns + from_seconds(delay_s).ns},
                         expose(config, world, plant, trial.seed, now, frames),
                         inbox.attitude()});
    }
    // 2. A picture becomes a command.
    if (!pending.empty() && pending.front().due <= now) {
      const PendingFrame& ready = pending.front();
      last =
          pilot.step(ready.frame, {.now = now,
                                   .tether = inbox.latest_tether(now),
                                   .station_from_body = station_from_world * ready.attitude,
                                   .others = {.attitude = ready.attitude,
                                              .inertial = inbox.take_inertial(ready.frame.stamp)}});
      if (observer) observer(ready.frame, last.estimate, last.decision);
      pending.pop_front();
    }
    // 3. The truth, a row for every picture of the camera.
    if (is_exposed) {
      ++frames;
      TrialSample sample = sample_of(plant, t_s, start.translation);
      sample.action = last.decision.action;
      sample.reason = last.decision.reason;
      sample.verdict = last.estimate.verdict;
      sample.command = last.decision.command;
      record.samples.push_back(sample);
    }
    plant.step(t_s, to_seconds(stamp_of_step(step + 1)), last.decision.command);
  }
  return record;
}

}  // namespace stillkite
