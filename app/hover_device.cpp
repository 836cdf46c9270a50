#include "app/hover_device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "app/interrupt.hpp"
#include "geometry/euler.hpp"
#include "io/config/config_printing.hpp"
#include "io/results/output_file.hpp"
#include "live/clock/local_clock.hpp"
#include "live/mavlink/axes.hpp"
#include "live/mavlink/sensor_messages.hpp"
#include "live/mavlink/telemetry.hpp"
#include "live/record/flight_files.hpp"
#include "live/tether/command_lines.hpp"
#include "simulation/hover/hover_streams.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

constexpr int kInControl = 1, kFlying = 2;  // modes, TetherConfig's defaults
constexpr double kCutCable_s = 0.5;

std::string local_udp(int port) {
  return fmt::format("udp://127.0.0.1:{}", port);
}

void sleep_until(Timestamp local) {
  const double wait_s = seconds_between(local_now(), local);
  if (wait_s > 0) std::this_thread::sleep_for(std::chrono::duration<double>(wait_s));
}

TrialSample device_sample(const HoverPlant& plant, const Eigen::Vector3d& start_in_world_m,
                          const TetherCommand& command) {
  const RigidTransform& drone = plant.truth().world_from_body;
  TrialSample sample;
  sample.t_s = plant.trial_s();
  sample.drone_in_world_m = drone.translation;
  sample.displacement_in_world_m = drone.translation - start_in_world_m;
  sample.station_in_world_m = plant.world_from_station().translation;
  sample.yaw_rad = to_euler(drone.rotation).yaw_rad;
  sample.action = HoldAction::command;
  sample.reason = HoldReason::none;
  sample.command = command;
  return sample;
}

}  // namespace

Timestamp device_stamp(const ServeConfig& config, Timestamp now) {
  const double skew_s = 1e-6 * config.clock_skew_ppm * to_seconds(now);
  return {now.ns + from_seconds(config.clock_offset_s + skew_s).ns};
}

DeviceCamera::DeviceCamera(const HoverConfig& config, const HoverWorld& world, const Trial& trial)
    : config_(config),
      video_(config, world, trial),
      sender_(local_udp(config.serve.video_port),
              {config.plant.camera.width_px, config.plant.camera.height_px},
              config.plant.camera.frames_per_s),
      jitter_(trial.seed, 1),
      thread_([this] { send_all(); }) {}

DeviceCamera::~DeviceCamera() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_one();
  }
  thread_.join();
}

void DeviceCamera::expose(const DroneTruth& truth, Timestamp now, const FaultEffect& fault) {
  constexpr std::size_t kMaxWaiting = 2;
  const std::lock_guard lock(mutex_);
  if (waiting_.size() == kMaxWaiting) {
    ++lost_;
    return;
  }
  waiting_.push_back({truth, now, local_now(), fault});
  changed_.notify_one();
}

void DeviceCamera::send_all() {
  while (true) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
    if (closed_) return;
    const Exposure exposure = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    send(exposure);
  }
}

void DeviceCamera::send(const Exposure& exposure) {
  constexpr double kWhenever_s = 1e6;
  video_.expose(exposure.truth, Eigen::Quaterniond::Identity(), exposure.now, exposure.fault);
  const auto image = video_.receive({exposure.now.ns + from_seconds(kWhenever_s).ns});
  if (!image) return;
  const double delay_s =
      config_.plant.camera_latency_s + jitter_.uniform(0, 1) * config_.serve.jitter_s;
  const Timestamp due{exposure.local.ns + from_seconds(delay_s).ns};
  sender_.encode(image->frame.grey, device_stamp(config_.serve, image->frame.stamp).ns);
  if (local_now() > due) ++late_;
  sleep_until(due);
  sender_.send();
}

DeviceStation::DeviceStation(const HoverConfig& config, const fs::path& terminal,
                             const Eigen::Quaterniond& station_from_world)
    : config_(config),
      station_from_world_(station_from_world),
      terminal_(terminal),
      mavlink_(
          {.host = "127.0.0.1", .port = static_cast<std::uint16_t>(config.serve.mavlink_port)},
          "serve.mavlink_port", [](auto&&...) {}, [] {}),
      sender_{.component = mavlink::kAutopilot} {
  mavlink_.start();
}

void DeviceStation::send(const HoverReadings& readings, Timestamp now) {
  for (const AttitudeReading& reading : readings.attitude) {
    attitude_ = station_from_world_ * reading.world_from_body;
    send_imu(reading);
  }
  waiting_.insert(waiting_.end(), readings.tether.begin(), readings.tether.end());
  while (!waiting_.empty() && waiting_.front().available <= now) {
    send_tether(waiting_.front());
    waiting_.pop_front();
  }
}

void DeviceStation::send_imu(const AttitudeReading& reading) {
  const Eigen::Vector3f force =
      mavlink::flip_axes(reading.specific_force_in_body_m_s2).cast<float>();
  const Eigen::Vector3f rate = mavlink::flip_axes(reading.angular_rate_in_body_rad_s).cast<float>();
  constexpr std::int64_t kNsPerUs = 1000;
  const mavlink::HighresImu imu{.time_usec = static_cast<std::uint64_t>(
                                    device_stamp(config_.serve, reading.stamp).ns / kNsPerUs),
                                .xacc = force.x(),
                                .yacc = force.y(),
                                .zacc = force.z(),
                                .xgyro = rate.x(),
                                .ygyro = rate.y(),
                                .zgyro = rate.z()};
  mavlink_.send(mavlink::encode(imu, sender_).bytes());
}

void DeviceStation::send_tether(const TetherSample& sample) {
  const TetherConfig wires;
  const TetherState& tether = sample.tether;
  const double counts = (tether.length_m - config_.plant.drone.start_length_m) / wires.m_per_count;
  const double elevation_rad = std::numbers::pi / 2 - tether.elevation_rad;
  const double t_s = to_seconds(sample.stamp);
  std::string lines = station_line(DroneAttitude{attitude_});
  lines += station_line(DronePosition{elevation_rad, tether.azimuth_rad,
                                      tether.length_m * std::sin(tether.elevation_rad)});
  lines += station_line(StationStatus{kInControl, t_s, 1, counts});
  lines += station_line(DroneStatus{kFlying, t_s, 1, 0});
  terminal_.write(lines);
}

TetherCommand DeviceStation::command(Timestamp now) {
  const TetherConfig wires;
  lines_.add(terminal_.read());
  while (const auto line = lines_.next()) {
    const ParsedCommand parsed = parse_command_line(*line, wires.m_per_count);
    if (parsed.position) {
      const double yaw_rate_rad_s = command_.yaw_rate_rad_s;
      command_ = *parsed.position;
      command_.yaw_rate_rad_s = yaw_rate_rad_s;
      const double dead_zone_m_s = wires.dead_zone_counts_s * wires.m_per_count;
      constexpr double kRounding = 1e-3;
      if (std::abs(command_.length_rate_m_s) < (1 - kRounding) * dead_zone_m_s) {
        command_.length_rate_m_s = 0;
      }
    }
    if (parsed.yaw_rate_rad_s) command_.yaw_rate_rad_s = *parsed.yaw_rate_rad_s;
    if (parsed.position || parsed.yaw_rate_rad_s) last_line_ = now;
  }
  if (last_line_ && seconds_between(*last_line_, now) > kCutCable_s) command_ = {};
  return command_;
}

FlyConfig device_flight(const HoverConfig& config, const fs::path& terminal,
                        double initial_height_m) {
  const SimulatedCameraConfig& camera = config.plant.camera;
  FlyConfig flight;
  flight.source.path = local_udp(config.serve.video_port);
  flight.source.latency_s = config.plant.camera_latency_s;
  flight.calibration.camera =
      CameraConfig{.width_px = camera.width_px,
                   .height_px = camera.height_px,
                   .focal_x_px = camera.focal_x_px,
                   .focal_y_px = camera.focal_y_px,
                   .centre_x_px = camera.centre_x_px,
                   .centre_y_px = camera.centre_y_px,
                   .distortion = camera.distortion,
                   .coefficients = {camera.coefficients.begin(), camera.coefficients.end()}};
  flight.mount.down_deg = 90 - camera.forward_tilt_deg;
  flight.initial.height_m = initial_height_m;
  flight.estimator = config.estimator;
  flight.navigator = config.navigator;
  flight.hold = config.hold;
  flight.live.mavlink = fmt::format("udp://:{}", config.serve.mavlink_port);
  flight.live.telemetry.imu = ImuMessage::highres;
  flight.live.send.odometry = false;
  flight.live.tether.port = fmt::format("serial:{}:115200", fs::absolute(terminal).string());
  flight.live.tether.length_at_zero_m = config.plant.drone.start_length_m;
  flight.live.tether.reading_latency_s = config.plant.sensors.tether.latency_s;
  flight.live.operator_source =
      fmt::format("unix:{}", (fs::absolute(terminal).parent_path() / "operator").string());
  return flight;
}

TrialRecord serve_trial(const HoverConfig& config, const HoverWorld& world, const Trial& trial,
                        const fs::path& folder) {
  HoverPlant plant(config, trial);
  plant.wait();
  HoverSensors sensors(config.plant.sensors,
                       hover_random(trial.seed, HoverStream::trial_sensors).bits());
  const Eigen::Vector3d start_in_world_m = plant.truth().world_from_body.translation;
  const fs::path terminal = folder / "station";
  DeviceStation station(config, terminal, plant.world_from_station().rotation.conjugate());
  DeviceCamera camera(config, world, trial);
  write_file(folder / kFlightConfig,
             print_config(
                 device_flight(config, terminal, sensors.measured_height_m(start_in_world_m.z()))));
  fmt::print(stderr, "stillkite: serve: ready; stillkite fly {}\n",
             (folder / kFlightConfig).string());

  constexpr double kFirstMove_s = 1;
  TrialRecord record{.trial = trial, .samples = {}, .kicks = plant.kicks(), .estimate_errors = {}};
  const Timestamp start = local_now();
  std::optional<Timestamp> moves_at;
  bool has_begun = false;
  for (std::int64_t images = 0; !plant.is_over() && !interrupted();) {
    const Timestamp now = plant.now();
    sleep_until({start.ns + now.ns});
    station.send(sensors.read(plant.truth(), now), now);
    const TetherCommand command = station.command(now);
    if (station.has_received() && !moves_at) {
      moves_at = Timestamp{now.ns + from_seconds(kFirstMove_s).ns};
      fmt::print(stderr, "stillkite: serve: first command; the station moves\n");
    }
    if (!has_begun && moves_at && now >= *moves_at) {
      has_begun = true;
      plant.begin();
    }
    const bool is_exposed =
        to_seconds(now) >= static_cast<double>(images) / config.plant.camera.frames_per_s - 1e-9;
    if (is_exposed) {
      ++images;
      camera.expose(plant.truth(), now, plant.fault());
      if (has_begun) {
        record.samples.push_back(device_sample(plant, start_in_world_m, command));
      }
    }
    plant.step(command);
  }
  if (camera.lost() + camera.late() > 0) {
    fmt::print(stderr, "stillkite: serve: the machine is too slow: {} images lost, {} late\n",
               camera.lost(), camera.late());
  }
  return record;
}

}  // namespace stillkite
