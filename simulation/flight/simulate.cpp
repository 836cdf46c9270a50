#include "simulation/flight/simulate.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "geometry/camera.hpp"
#include "simulation/flight/vehicle_path.hpp"
#include "simulation/random.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/renderer.hpp"
#include "simulation/scene/procedural_ground.hpp"

namespace stillkite {
namespace {

// Random streams of the seed.
enum Stream : std::uint64_t {
  kGround = 1,
  kRelief,
  kVehicle,
  kFlight,
  kImu,
  kRange,
  kNoise,
  kFlicker
};

std::uint64_t seed_of(const SimulationConfig& config, Stream stream) {
  return Random(static_cast<std::uint64_t>(config.seed), stream).bits();
}

std::int64_t frame_count(const SimulationConfig& config) {
  return static_cast<std::int64_t>(
             std::floor(config.flight.duration_s * config.camera.frames_per_s + 1e-9)) +
         1;
}

double time_of(const SimulationConfig& config, std::int64_t frame) {
  return static_cast<double>(frame) / config.camera.frames_per_s;
}

std::shared_ptr<const Relief> make_relief(const SimulationConfig& config) {
  if (config.ground.relief.amplitude_m == 0) return nullptr;
  return std::make_shared<Relief>(config.ground.relief, seed_of(config, kRelief));
}

Scene make_scene(const SimulationConfig& config, const cv::Mat& photograph) {
  constexpr double kPixelsPerTexel = 0.8;
  const double pixel_m = config.flight.height_m / config.camera.focal_x_px;
  const double texel_m = config.ground.metres_per_texel.value_or(kPixelsPerTexel * pixel_m);
  const int side = config.ground.side_texels;
  const cv::Mat image =
      photograph.empty() ? procedural_ground(side, side, seed_of(config, kGround)) : photograph;
  Scene scene{.ground = std::make_shared<GroundTexture>(image, texel_m),
              .relief = make_relief(config)};
  if (config.vehicle) {
    scene.vehicle = std::make_shared<GroundTexture>(
        procedural_ground(512, 256, seed_of(config, kVehicle)), 1.0);
  }
  return scene;
}

double gain_at(const SimulationConfig& config, std::int64_t frame) {
  const double progress = time_of(config, frame) / config.flight.duration_s;
  Random random(seed_of(config, kFlicker), static_cast<std::uint64_t>(frame));
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

// Camera of a flight over its scene.
class FlightCamera {
 public:
  FlightCamera(const SimulationConfig& config, const cv::Mat& photograph)
      : config_(config),
        trajectory_(make_trajectory(config.flight, seed_of(config, kFlight))),
        scene_(make_scene(config, photograph)),
        renderer_(config.camera.lens(), config.camera.supersampling),
        body_from_camera_(config.camera.body_from_camera()) {}

  // Noise-free image. `t_s`: time of the middle row (rolling shutter).
  void render(double t_s, cv::Mat& image) const {
    const double readout_s = config_.camera.readout_s;
    const int rows = readout_s > 0 ? 1 : image.rows;
    for (int row = 0; row < image.rows; row += rows) {
      const double now_s = t_s + row_time_offset_s(readout_s, row, image.rows);
      renderer_.render_rows(scene_, trajectory_.at(now_s).world_from_body * body_from_camera_,
                            place_vehicle(config_, trajectory_, now_s), {row, row + rows}, image);
    }
  }

 private:
  const SimulationConfig& config_;
  Trajectory trajectory_;
  Scene scene_;
  Renderer renderer_;
  RigidTransform body_from_camera_;
};

}  // namespace

FlightRecord record_flight(const SimulationConfig& config) {
  if (config.camera.readout_s * config.camera.frames_per_s > 1 + 1e-9) {
    throw InputError("camera.readout_s: " + std::to_string(config.camera.readout_s) +
                     " s exceeds the frame interval; use at most 1 / camera.frames_per_s");
  }
  const Trajectory trajectory = make_trajectory(config.flight, seed_of(config, kFlight));
  const double duration_s = config.flight.duration_s;
  FlightRecord record{
      .camera = config.camera.lens(),
      .body_from_camera = config.camera.body_from_camera(),
      .truth = {},
      .twists_in_camera = {},
      .imu = simulate_imu(trajectory, config.imu, duration_s, seed_of(config, kImu)),
      .range = simulate_range(trajectory, make_relief(config).get(), config.range, duration_s,
                              seed_of(config, kRange))};
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

void render_flight(const SimulationConfig& config, const cv::Mat& photograph,
                   const FrameSink& sink) {
  const FlightCamera camera(config, photograph);
  const std::uint64_t noise_seed = seed_of(config, kNoise);
  const int instants = config.camera.shutter_s > 0 ? config.camera.shutter_samples : 1;
  cv::Mat image(config.camera.height_px, config.camera.width_px, CV_32FC1);

  for (std::int64_t frame = 0; frame < frame_count(config); ++frame) {
    cv::Mat irradiance = cv::Mat::zeros(image.size(), CV_32FC1);
    for (int instant = 0; instant < instants; ++instant) {
      const double offset = (instant + 0.5) / instants - 0.5;
      camera.render(time_of(config, frame) + offset * config.camera.shutter_s, image);
      irradiance += image;
    }
    const Exposure exposure{.gain = gain_at(config, frame) / instants,
                            .noise_grey = config.camera.noise_grey};
    sink({.stamp = from_seconds(time_of(config, frame)),
          .index = frame,
          .grey = develop(irradiance, exposure, noise_seed + static_cast<std::uint64_t>(frame))});
  }
}

}  // namespace stillkite
