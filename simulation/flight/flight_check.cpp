#include "simulation/flight/flight_check.hpp"
#include "simulation/scene/scenes.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace stillkite {
namespace {

void check_times(const SimulationConfig& config) {
  const double frame_interval_s = 1 / config.camera.frames_per_s;
  if (config.camera.readout_s > frame_interval_s + 1e-9) {
    throw InputError(
        fmt::format("camera.readout_s: {} s exceeds the frame interval; use at most 1 / "
                    "camera.frames_per_s",
                    config.camera.readout_s));
  }
  const double imu_interval_s = (1 + 1e-6 * config.clock.imu_skew_ppm) / config.imu.rate_hz;
  const double shortest_s = std::min(frame_interval_s, imu_interval_s);
  if (config.clock.rounding_s > shortest_s) {
    throw InputError(
        fmt::format("clock.rounding_s: {} s gives equal stamps; use at most {} s, the interval of "
                    "images and IMU readings",
                    config.clock.rounding_s, shortest_s));
  }
  if (config.imu.gap_s >= config.imu.gap_every_s) {
    throw InputError(
        fmt::format("imu.gap_s: {} s leaves no readings; use less than "
                    "imu.gap_every_s, {} s",
                    config.imu.gap_s, config.imu.gap_every_s));
  }
}

void check_scene(const SimulationConfig& config) {
  if (config.scene == FlightScene::ground) return;
  if (config.vehicle || config.shadow) {
    throw InputError(fmt::format("{}: requires scene: ground, not {}; remove it or change scene",
                                 config.vehicle ? "vehicle" : "shadow", name_of(config.scene)));
  }
  const int samples = config.camera.supersampling * config.camera.supersampling;
  if (config.camera.shutter_s > 0 && samples % config.camera.shutter_samples != 0) {
    throw InputError(
        fmt::format("camera.shutter_samples: {} does not divide the {} samples of a pixel in scene "
                    "{}; choose a divisor of the square of camera.supersampling",
                    config.camera.shutter_samples, samples, name_of(config.scene)));
  }
}

// Margin for the near distance at which a wall is still visible.
void check_inside_room(const SimulationConfig& config, const Trajectory& trajectory) {
  constexpr double kStep_s = 0.1;
  constexpr double kMargin_m = 0.05;
  const Eigen::Array3d half = 0.5 * room_size_m().array();
  const Eigen::Array3d centre(0, 0, half.z());
  for (double t_s = 0; t_s <= config.flight.duration_s; t_s += kStep_s) {
    const RigidTransform camera =
        trajectory.at(t_s).world_from_body * config.camera.body_from_camera();
    if (((camera.translation.array() - centre).abs() > half - kMargin_m).any()) {
      throw InputError(
          fmt::format("scene: at {:.1f} s the camera leaves the room of {} x {} x {} m; reduce the "
                      "displacement or the sway of flight",
                      t_s, room_size_m().x(), room_size_m().y(), room_size_m().z()));
    }
  }
}

}  // namespace

void check_flight(const SimulationConfig& config, const Trajectory& trajectory) {
  check_times(config);
  check_scene(config);
  if (config.scene == FlightScene::room) check_inside_room(config, trajectory);
}

}  // namespace stillkite
