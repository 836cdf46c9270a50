#include "simulation/scene/scenes.hpp"

#include <cmath>
#include <memory>
#include <numbers>

#include "simulation/random.hpp"
#include "simulation/scene/procedural_ground.hpp"
#include "simulation/scene/scene_builder.hpp"

namespace stillkite {
namespace {

constexpr Material kWater{{.grey = 92, .grain_grey = 12}, 0.03};
constexpr Material kCloud{{.grey = 205, .grain_grey = 13}, 0.8};
constexpr Material kHill{{.grey = 118, .grain_grey = 24}, 0.35};
constexpr Material kRock{{.grey = 84, .grain_grey = 26}, 0.012};
constexpr Material kFacade{{.grey = 172,
                            .grain_grey = 5,
                            .tile_width = 75,
                            .tile_height = 90,
                            .tile_grey = 32,
                            .joint_grey = -45,
                            .marks_a_megatexel = 1200,
                            .mark_size = 16,
                            .mark_grey = 120},
                           0.03};
constexpr Material kSeaWall{{.grey = 140,
                             .grain_grey = 9,
                             .tile_width = 45,
                             .tile_height = 18,
                             .tile_grey = 18,
                             .joint_grey = -50},
                            0.02};
constexpr Material kHull{{.grey = 190,
                          .grain_grey = 5,
                          .tile_width = 400,
                          .tile_height = 24,
                          .tile_grey = 30,
                          .joint_grey = -70,
                          .marks_a_megatexel = 300,
                          .mark_size = 16,
                          .mark_grey = 120},
                         0.006};

// The shore runs from the near right to the far left of the boat.
constexpr double kShoreHeading_rad = 0.35;  // inland direction
constexpr double kShore_m = 14;             // distance of the sea wall from the origin
constexpr double kShoreWidth_m = 160;
constexpr double kShoreDepth_m = 120;
constexpr double kShoreHeight_m = 0.9;

// Shore coordinates to world: inland from the sea wall, left along it, up from the beach.
Eigen::Vector3d on_shore(double inland_m, double left_m, double up_m) {
  const Eigen::Vector3d inland(std::cos(kShoreHeading_rad), std::sin(kShoreHeading_rad), 0);
  const Eigen::Vector3d left(-inland.y(), inland.x(), 0);
  constexpr double kMiddle_m = -55;
  return (kShore_m + inland_m) * inland + (kMiddle_m + left_m) * left +
         Eigen::Vector3d(0, 0, kShoreHeight_m + up_m);
}

void add_land(SceneBuilder& builder, std::uint64_t seed) {
  constexpr double kTexel_m = 0.04;
  const auto grass = std::make_shared<GroundTexture>(procedural_ground(2048, 2048, seed), kTexel_m);
  const Eigen::Vector3d inland = on_shore(1, 0, 0) - on_shore(0, 0, 0);
  const Eigen::Vector3d left = on_shore(0, 1, 0) - on_shore(0, 0, 0);
  builder.add({.corner_in_world_m = on_shore(0, kShoreWidth_m / 2, 0),
               .right_in_world_m = kShoreDepth_m * inland,
               .down_in_world_m = -kShoreWidth_m * left,
               .texture = grass});
  builder.add_vertical_patch(on_shore(0, 0, -kShoreHeight_m), kShoreHeading_rad + std::numbers::pi,
                             kShoreWidth_m, kShoreHeight_m, kSeaWall);
}

void add_houses(SceneBuilder& builder, Random& random) {
  for (int house = 0; house < 11; ++house) {
    const double inland_m = 7.0 + 9 * (house % 3) + random.uniform(-2, 2);
    const double left_m = 72.0 - 11 * house + random.uniform(-2, 2);
    builder.add_box({on_shore(inland_m, left_m, 0),
                     {random.uniform(5, 8), random.uniform(6, 10), random.uniform(3.5, 8)},
                     kShoreHeading_rad + random.uniform(-0.3, 0.3)},
                    kFacade);
  }
}

void add_rocks(SceneBuilder& builder, Random& random) {
  for (int rock = 0; rock < 22; ++rock) {
    const double distance_m = random.uniform(5, 13);
    const double bearing_rad = random.uniform(-0.75, 0.75);
    const double size_m = random.uniform(0.4, 1.5);
    builder.add_box({{distance_m * std::cos(bearing_rad), distance_m * std::sin(bearing_rad), 0},
                     {size_m, size_m * random.uniform(0.6, 1.2), size_m * random.uniform(0.3, 0.9)},
                     random.uniform(0, std::numbers::pi)},
                    kRock);
  }
}

void add_boat(SceneBuilder& builder) {
  const double heading_rad = 0.9;
  builder.add_box({{9.5, 4.5, 0}, {5, 1.8, 0.8}, heading_rad}, kHull);
  builder.add_box({{9.2, 4.1, 0.8}, {1.8, 1.3, 1.2}, heading_rad}, kHull);
  builder.add_box({{9.8, 4.9, 0.8}, {0.12, 0.12, 4}, heading_rad}, kHull);
}

}  // namespace

PatchScene make_coast(std::uint64_t seed) {
  constexpr double kSea_m = 8000;
  constexpr double kCloudHeight_m = 500;
  Random random(seed, 2);
  SceneBuilder builder(seed);
  builder.add_horizontal_patch({0, 0, 0}, 0, kSea_m, kSea_m, true, kWater);
  builder.add_horizontal_patch({0, 0, kCloudHeight_m}, 0.4, 2 * kSea_m, 2 * kSea_m, false, kCloud);
  // distant hills behind the land, and an island
  for (const double bearing_rad : {-0.7, -0.35, 0.05}) {
    builder.add_box({{random.uniform(260, 420) * std::cos(bearing_rad),
                      random.uniform(260, 420) * std::sin(bearing_rad), 0},
                     {80, random.uniform(120, 220), random.uniform(22, 45)},
                     bearing_rad},
                    kHill);
  }
  builder.add_box({{700, 420, 0}, {60, 180, 22}, 0.5}, kHill);
  add_land(builder, Random(seed, 3).bits());
  add_houses(builder, random);
  add_rocks(builder, random);
  add_boat(builder);
  return builder.scene();
}

}  // namespace stillkite
