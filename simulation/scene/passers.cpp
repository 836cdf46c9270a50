#include "simulation/scene/passers.hpp"

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

// To `reach` and back through the middle to -reach, evenly, from 0 upwards.
double to_and_fro(double way, double reach) {
  const double folded = std::abs(std::remainder(way - reach, 4 * reach));
  return reach - folded;
}

}  // namespace

std::vector<Passer> make_passers(const PasserConfig& config, std::uint64_t seed) {
  constexpr double kBetween_m = 0.2;
  Random random(seed);
  SceneBuilder builder(random.bits());
  for (int i = 0; i < config.count; ++i) {
    builder.add_upright({config.distance_m + kBetween_m * i, 0, 0}, std::numbers::pi,
                        config.width_m, config.height_m, kClothes);
  }
  std::vector<Passer> passers;
  passers.reserve(config.count);
  for (const Patch& patch : builder.scene().patches) {
    passers.push_back({patch, random.uniform(0, 4 * config.reach_m)});
  }
  return passers;
}

PatchScene with_passers(PatchScene scene, const PasserConfig& config,
                        const std::vector<Passer>& passers, double t_s) {
  scene.patches.reserve(scene.patches.size() + passers.size());
  for (const Passer& passer : passers) {
    Patch patch = passer.at_middle;
    patch.corner_in_world_m.y() +=
        to_and_fro(passer.way_before_m + config.speed_m_s * t_s, config.reach_m);
    scene.patches.push_back(patch);
  }
  return scene;
}

}  // namespace stillkite
