#include "simulation/flight/flight_camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>

#include "simulation/flight/flight_streams.hpp"
#include "simulation/flight/shadow_path.hpp"
#include "simulation/flight/vehicle_path.hpp"
#include "simulation/scene/procedural_ground.hpp"
#include "simulation/scene/scenes.hpp"

namespace stillkite {
namespace {

std::shared_ptr<const GroundTexture> make_ground(const SimulationConfig& config,
                                                 const cv::Mat& photograph) {
  constexpr double kPixelsPerTexel = 0.8;
  const GroundConfig& ground = config.ground;
  const double pixel_m = config.flight.height_m / config.camera.focal_x_px;
  const double texel_m = ground.metres_per_texel.value_or(kPixelsPerTexel * pixel_m);
  const auto image_of = [&](int side) {
    return photograph.empty()
               ? procedural_ground(side, side, flight_seed(config.seed, FlightStream::ground))
               : photograph;
  };
  if (!ground.period_m) {
    return std::make_shared<GroundTexture>(image_of(ground.side_texels), texel_m);
  }
  const int period = ground.period_texels(texel_m);
  const int side =
      photograph.empty() ? ground.side_texels : std::min(photograph.cols, photograph.rows);
  if (period / 2 >= side) {
    throw InputError(fmt::format(
        "ground.period_m: half of {} m exceeds the {} texels of {:.3g} m of the texture; reduce "
        "it, "
        "or increase ground.metres_per_texel{}",
        *ground.period_m, side, texel_m, photograph.empty() ? " or ground.side_texels" : ""));
  }
  return std::make_shared<GroundTexture>(
      repetitive_ground(image_of(period / 2 + 1), period, ground.side_texels),
      *ground.period_m / period);
}

Scene make_scene(const SimulationConfig& config, const cv::Mat& photograph) {
  Scene scene{.ground = make_ground(config, photograph), .relief = make_relief(config)};
  if (config.vehicle) {
    scene.vehicle = std::make_shared<GroundTexture>(
        procedural_ground(512, 256, flight_seed(config.seed, FlightStream::vehicle)), 1.0);
  }
  return scene;
}

LensError lens_error_of(const SimulationConfig& config) {
  return random_lens_error(config.camera.lens(), config.camera.lens_error_px,
                           flight_seed(config.seed, FlightStream::lens));
}

}  // namespace

std::shared_ptr<const Relief> make_relief(const SimulationConfig& config) {
  if (config.ground.relief.amplitude_m == 0) return nullptr;
  return std::make_shared<Relief>(config.ground.relief,
                                  flight_seed(config.seed, FlightStream::relief));
}

FlightCamera::FlightCamera(const SimulationConfig& config, const cv::Mat& photograph)
    : config_(config),
      trajectory_(make_trajectory(config.flight, flight_seed(config.seed, FlightStream::flight))),
      body_from_camera_(config.camera.body_from_camera()),
      world_([&]() -> std::variant<Ground, Patches> {
        const Camera camera = config.camera.lens();
        const int supersampling = config.camera.supersampling;
        const LensError error = lens_error_of(config);
        if (config.scene == FlightScene::ground) {
          return Ground{make_scene(config, photograph), Renderer(camera, supersampling, error)};
        }
        const std::uint64_t seed = flight_seed(config.seed, FlightStream::scene);
        return Patches{config.scene == FlightScene::room ? make_room(seed) : make_coast(seed),
                       PatchRenderer(camera, supersampling, error)};
      }()) {}

RigidTransform FlightCamera::world_from_camera(double t_s) const {
  return trajectory_.at(t_s).world_from_body * body_from_camera_;
}

IrradianceSum FlightCamera::expose(double t_s) const {
  return std::visit([&](const auto& world) { return expose(world, t_s); }, world_);
}

IrradianceSum FlightCamera::expose(const Ground& ground, double t_s) const {
  const SimulatedCameraConfig& camera = config_.camera;
  const int instants = camera.shutter_s > 0 ? camera.shutter_samples : 1;
  cv::Mat image(camera.height_px, camera.width_px, CV_32FC1);
  cv::Mat sum = cv::Mat::zeros(image.size(), CV_32FC1);
  for (int instant = 0; instant < instants; ++instant) {
    const double offset = (instant + 0.5) / instants - 0.5;
    render(ground, t_s + offset * camera.shutter_s, image);
    sum += image;
  }
  return {sum, instants};
}

// Noise-free image of one instant. `t_s`: time of the middle row.
void FlightCamera::render(const Ground& ground, double t_s, cv::Mat& image) const {
  const double readout_s = config_.camera.readout_s;
  const int rows = readout_s > 0 ? 1 : image.rows;
  for (int row = 0; row < image.rows; row += rows) {
    const double now_s = t_s + row_time_offset_s(readout_s, row, image.rows);
    const GroundObjects objects{.vehicle = place_vehicle(config_, trajectory_, now_s),
                                .shadow = place_shadow(config_, trajectory_, now_s)};
    ground.renderer.render_rows(ground.scene, world_from_camera(now_s), objects, {row, row + rows},
                                image);
  }
}

IrradianceSum FlightCamera::expose(const Patches& patches, double t_s) const {
  const SimulatedCameraConfig& camera = config_.camera;
  const int rows = camera.readout_s > 0 ? 1 : camera.height_px;
  cv::Mat image(camera.height_px, camera.width_px, CV_32FC1);
  for (int row = 0; row < camera.height_px; row += rows) {
    const double now_s = t_s + row_time_offset_s(camera.readout_s, row, camera.height_px);
    const Shutter shutter{
        .world_from_camera_at_opening = world_from_camera(now_s - 0.5 * camera.shutter_s),
        .world_from_camera_at_closing = world_from_camera(now_s + 0.5 * camera.shutter_s),
        .instants = camera.shutter_s > 0 ? camera.shutter_samples : 1};
    patches.renderer.render_rows(patches.scene, shutter, {row, row + rows}, image);
  }
  return {image, 1};
}

}  // namespace stillkite
