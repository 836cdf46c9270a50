#include "simulation/hover/hover_plant.hpp"

#include <cmath>

#include "simulation/camera_mount.hpp"
#include "simulation/hover/hover_streams.hpp"

namespace stillkite {
namespace {

// Common multiple of 30 Hz, 50 Hz and 200 Hz.
constexpr std::int64_t kHoverStepsPerSecond = 600;

Timestamp stamp_of_hover_step(std::int64_t step) {
  return from_seconds(static_cast<double>(step) / kHoverStepsPerSecond);
}

}  // namespace

double trial_duration_s(const HoverConfig& config, const Trial& trial) {
  return StationPath(config.plant.station, trial.axis).duration_s();
}

HoverPlant::HoverPlant(const HoverConfig& config, const Trial& trial)
    : path_(config.plant.station, trial.axis),
      sea_(config.plant.sea),
      waves_(sea_ ? make_waves(*sea_, hover_random(trial.seed, HoverStream::trial_sea).bits())
                  : std::vector<RegularWave>{}),
      fault_(config.plant.fault),
      wind_(config.plant.wind, hover_random(trial.seed, HoverStream::trial_wind).bits()),
      drone_(config.plant.drone, camera_raised_forward(config.plant.camera.forward_tilt_deg),
             station(0), 0),
      last_step_(static_cast<std::int64_t>(std::ceil(path_.duration_s() * kHoverStepsPerSecond))) {
  if (config.plant.yaw_kicks) {
    kicks_ = make_yaw_kicks(*config.plant.yaw_kicks, path_.duration_s(),
                            hover_random(trial.seed, HoverStream::trial_kicks).bits());
  }
}

Timestamp HoverPlant::now() const {
  return stamp_of_hover_step(step_);
}

void HoverPlant::begin() {
  begin_step_ = step_;
}

double HoverPlant::trial_s() const {
  return begin_step_ ? to_seconds(stamp_of_hover_step(step_ - *begin_step_)) : 0;
}

StationState HoverPlant::station(double trial_s) const {
  const StationState on_land = path_.at(trial_s);
  return sea_ ? station_on_boat(on_land, *sea_, waves_, trial_s) : on_land;
}

RigidTransform HoverPlant::world_from_station() const {
  return station(trial_s()).world_from_station;
}

FaultEffect HoverPlant::fault() const {
  return fault_ ? effect_of(*fault_, trial_s()) : FaultEffect{};
}

// The end of a step equals the start of the next bit for bit, so that each event occurs once.
void HoverPlant::step(const TetherCommand& command) {
  constexpr double kStep_s = 1.0 / kHoverStepsPerSecond;
  const double from_s = trial_s();
  const double loose_tether_m = fault().loose_tether_m;
  ++step_;
  const double to_s = trial_s();
  wind_.step(kStep_s);
  drone_.step(command,
              {.wind_in_world_m_s = wind_.in_world_m_s(),
               .yaw_kick_rad = kick_yaw_rad(kicks_, from_s, to_s),
               .loose_tether_m = loose_tether_m},
              station(to_s), kStep_s);
}

}  // namespace stillkite
