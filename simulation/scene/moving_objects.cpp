#include "simulation/scene/moving_objects.hpp"

#include <cmath>
#include <numbers>

#include "simulation/random.hpp"
#include "simulation/scene/scene_builder.hpp"

namespace stillkite {
namespace {

constexpr Material kClothes{{.grey = 88,
                             .grain_grey = 12,
                             .tile_width = 40,
                             .tile_height = 55,
                             .tile_grey = 30,
                             .joint_grey = -25,
                             .marks_a_megatexel = 2500,
                             .mark_size = 12,
                             .mark_grey = 100},
                            0.006};

// Position after a path length: rises from 0 to +amplitude, falls to -amplitude, returns to 0.
double triangle_wave(double path, double amplitude) {
  const double folded = std::abs(std::remainder(path - amplitude, 4 * amplitude));
  return amplitude - folded;
}

}  // namespace

std::vector<MovingObject> make_moving_objects(const MovingObjectConfig& config,
                                              std::uint64_t seed) {
  constexpr double kSpacing_m = 0.2;
  Random random(seed);
  SceneBuilder builder(random.bits());
  for (int i = 0; i < config.count; ++i) {
    builder.add_vertical_patch({config.distance_m + kSpacing_m * i, 0, 0}, std::numbers::pi,
                               config.width_m, config.height_m, kClothes);
  }
  std::vector<MovingObject> moving_objects;
  moving_objects.reserve(config.count);
  for (const Patch& patch : builder.scene().patches) {
    moving_objects.push_back({patch, random.uniform(0, 4 * config.reach_m)});
  }
  return moving_objects;
}

PatchScene with_moving_objects(PatchScene scene, const MovingObjectConfig& config,
                               const std::vector<MovingObject>& moving_objects, double t_s) {
  scene.patches.reserve(scene.patches.size() + moving_objects.size());
  for (const MovingObject& moving_object : moving_objects) {
    Patch patch = moving_object.at_centre;
    patch.corner_in_world_m.y() +=
        triangle_wave(moving_object.initial_path_m + config.speed_m_s * t_s, config.reach_m);
    scene.patches.push_back(patch);
  }
  return scene;
}

}  // namespace stillkite
