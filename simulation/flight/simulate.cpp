#include "simulation/flight/simulate.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "simulation/flight/flight_check.hpp"
#include "simulation/flight/flight_streams.hpp"
#include "simulation/random.hpp"
#include "simulation/render/develop.hpp"

namespace stillkite {
namespace {

std::int64_t frame_count(const SimulationConfig& config) {
  return static_cast<std::int64_t>(
             std::floor(config.flight.duration_s * config.camera.frames_per_s + 1e-9)) +
         1;
}

double time_of(const SimulationConfig& config, std::int64_t frame) {
  return static_cast<double>(frame) / config.camera.frames_per_s;
}

std::vector<Timestamp> recorded_image_stamps(const SimulationConfig& config) {
  std::vector<Timestamp> exposures;
  for (std::int64_t frame = 0; frame < frame_count(config); ++frame) {
    exposures.push_back(from_seconds(time_of(config, frame)));
  }
  return image_stamps(config.clock, exposures, flight_seed(config.seed, FlightStream::clock));
}

double gain_at(const SimulationConfig& config, std::int64_t frame) {
  const double progress = time_of(config, frame) / config.flight.duration_s;
  Random random(flight_seed(config.seed, FlightStream::flicker), static_cast<std::uint64_t>(frame));
  return config.camera.gain(progress, random.uniform(-1.0, 1.0));
}

// Velocity of the camera at the lever arm l: v + w x l.
Twist camera_twist(const MotionState& state, const RigidTransform& body_from_camera) {
  const Eigen::Quaterniond camera_from_body = body_from_camera.rotation.conjugate();
  const Eigen::Vector3d& rate = state.angular_rate_in_body_rad_s;
  const Eigen::Vector3d velocity_in_body_m_s =
      state.world_from_body.rotation.conjugate() * state.velocity_in_world_m_s +
      rate.cross(body_from_camera.translation);
  return {camera_from_body * velocity_in_body_m_s, camera_from_body * rate};
}

// Readings that arrive, with the stamps of the IMU's clock.
std::vector<ImuReading> recorded_imu(const SimulationConfig& config, const Trajectory& trajectory) {
  std::vector<ImuReading> readings = simulate_imu(trajectory, config.imu, config.flight.duration_s,
                                                  flight_seed(config.seed, FlightStream::imu));
  std::erase_if(readings, [&](const ImuReading& reading) {
    return config.imu.is_in_gap(to_seconds(reading.stamp));
  });
  for (ImuReading& reading : readings) {
    if (config.imu.removes_gravity) {
      const MotionState state = trajectory.at(to_seconds(reading.stamp));
      reading.specific_force_in_body_m_s2 +=
          state.world_from_body.rotation.conjugate() * gravity_in_world_m_s2();
    }
    reading.stamp = imu_stamp(config.clock, reading.stamp);
  }
  return readings;
}

std::vector<RangeReading> recorded_range(const SimulationConfig& config,
                                         const Trajectory& trajectory) {
  if (config.scene != FlightScene::ground) return {};
  return simulate_range(trajectory, make_relief(config).get(), config.range,
                        config.flight.duration_s, flight_seed(config.seed, FlightStream::range));
}

}  // namespace

FlightRecord record_flight(const SimulationConfig& config) {
  const Trajectory trajectory =
      make_trajectory(config.flight, flight_seed(config.seed, FlightStream::flight));
  check_flight(config, trajectory);
  FlightRecord record{.camera = config.camera.lens(),
                      .body_from_camera = config.camera.body_from_camera(),
                      .truth = {},
                      .twists_in_camera = {},
                      .imu = recorded_imu(config, trajectory),
                      .range = recorded_range(config, trajectory)};
  for (std::int64_t frame = 0; frame < frame_count(config); ++frame) {
    const double t_s = time_of(config, frame);
    record.truth.push_back({from_seconds(t_s), trajectory.at(t_s)});
    if (frame == 0) continue;
    const MotionState half_way = trajectory.at(t_s - 0.5 / config.camera.frames_per_s);
    record.twists_in_camera.push_back(
        {from_seconds(t_s), camera_twist(half_way, record.body_from_camera)});
  }
  return record;
}

FlightImages::FlightImages(const SimulationConfig& config, const cv::Mat& photograph)
    : config_(std::make_unique<const SimulationConfig>(config)),
      camera_(*config_, photograph),
      stamps_(recorded_image_stamps(*config_)) {}

Frame FlightImages::render(std::int64_t index) const {
  const std::uint64_t noise_seed = flight_seed(config_->seed, FlightStream::noise);
  const IrradianceSum irradiance = camera_.expose(time_of(*config_, index));
  const Exposure exposure = config_->camera.exposure(gain_at(*config_, index) / irradiance.images);
  return {
      .stamp = stamps_[index],
      .index = index,
      .grey = develop(irradiance.sum, exposure, noise_seed + static_cast<std::uint64_t>(index))};
}

void render_flight(const SimulationConfig& config, const cv::Mat& photograph,
                   const FrameSink& sink) {
  const FlightImages images(config, photograph);
  for (std::int64_t index = 0; index < images.count(); ++index) sink(images.render(index));
}

}  // namespace stillkite
