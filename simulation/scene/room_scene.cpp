#include "simulation/scene/scenes.hpp"

#include <cmath>
#include <numbers>

#include "simulation/random.hpp"
#include "simulation/scene/scene_builder.hpp"

namespace stillkite {
namespace {

constexpr double kLength_m = 12;
constexpr double kWidth_m = 10;
constexpr double kHeight_m = 4;

constexpr Material kFloor{{.grey = 118,
                           .grain_grey = 7,
                           .tile_width = 114,
                           .tile_height = 23,
                           .tile_grey = 11,
                           .joint_grey = -40,
                           .marks_a_megatexel = 2400,
                           .mark_size = 7,
                           .mark_grey = 70},
                          0.009};
constexpr Material kWall{
    {.grey = 168, .grain_grey = 6, .marks_a_megatexel = 1900, .mark_size = 10, .mark_grey = 85},
    0.009};
constexpr Material kCeiling{{.grey = 195,
                             .grain_grey = 3,
                             .tile_width = 67,
                             .tile_height = 67,
                             .tile_grey = 6,
                             .joint_grey = -55,
                             .marks_a_megatexel = 1100,
                             .mark_size = 5,
                             .mark_grey = 45},
                            0.009};
constexpr Material kCarton{
    {.grey = 126, .grain_grey = 5, .marks_a_megatexel = 2500, .mark_size = 15, .mark_grey = 95},
    0.0055};
constexpr Material kCabinet{{.grey = 96,
                             .grain_grey = 4,
                             .tile_width = 100,
                             .tile_height = 65,
                             .tile_grey = 14,
                             .joint_grey = -50,
                             .marks_a_megatexel = 900,
                             .mark_size = 13,
                             .mark_grey = 90},
                            0.0055};
constexpr Material kShelf{{.grey = 90,
                           .grain_grey = 6,
                           .tile_width = 9,
                           .tile_height = 50,
                           .tile_grey = 45,
                           .joint_grey = -50,
                           .marks_a_megatexel = 900,
                           .mark_size = 8,
                           .mark_grey = 90},
                          0.0055};
constexpr Material kTable{
    {.grey = 150, .grain_grey = 7, .marks_a_megatexel = 2200, .mark_size = 13, .mark_grey = 90},
    0.0055};
constexpr Material kPoster{
    {.grey = 205, .grain_grey = 6, .marks_a_megatexel = 2800, .mark_size = 16, .mark_grey = 180},
    0.0055};

void add_shell(SceneBuilder& builder) {
  const double half = std::numbers::pi / 2;
  builder.add_horizontal_patch({0, 0, 0}, 0, kLength_m, kWidth_m, true, kFloor);
  builder.add_horizontal_patch({0, 0, kHeight_m}, 0, kLength_m, kWidth_m, false, kCeiling);
  builder.add_vertical_patch({kLength_m / 2, 0, 0}, 2 * half, kWidth_m, kHeight_m, kWall);
  builder.add_vertical_patch({-kLength_m / 2, 0, 0}, 0, kWidth_m, kHeight_m, kWall);
  builder.add_vertical_patch({0, kWidth_m / 2, 0}, -half, kLength_m, kHeight_m, kWall);
  builder.add_vertical_patch({0, -kWidth_m / 2, 0}, half, kLength_m, kHeight_m, kWall);
}

// Posters 1 cm in front of the walls: three on each long wall, two on each short wall.
void add_posters(SceneBuilder& builder, Random& random) {
  const double half = std::numbers::pi / 2;
  const double gap_m = 0.01;
  for (const double side : {1.0, -1.0}) {
    for (const double along_m : {-3.6, 0.2, 3.4}) {
      builder.add_vertical_patch({along_m + random.uniform(-0.4, 0.4),
                                  side * (kWidth_m / 2 - gap_m), random.uniform(1.3, 2.1)},
                                 -side * half, random.uniform(0.8, 1.5), random.uniform(0.9, 1.5),
                                 kPoster);
    }
    for (const double along_m : {-2.2, 1.6}) {
      builder.add_vertical_patch({side * (kLength_m / 2 - gap_m),
                                  along_m + random.uniform(-0.5, 0.5), random.uniform(1.4, 2.2)},
                                 side > 0 ? 2 * half : 0, random.uniform(0.9, 1.6),
                                 random.uniform(0.9, 1.5), kPoster);
    }
  }
}

// Table top on two side panels, with a carton on it.
void add_table(SceneBuilder& builder, const Eigen::Vector2d& at_m, double heading_rad,
               Random& random) {
  const Eigen::Vector3d middle(at_m.x(), at_m.y(), 0);
  const Eigen::Vector3d along(std::cos(heading_rad), std::sin(heading_rad), 0);
  builder.add_box({middle + Eigen::Vector3d(0, 0, 0.72), {1.6, 0.8, 0.04}, heading_rad}, kTable);
  for (const double side : {-0.72, 0.72}) {
    builder.add_box({middle + side * along, {0.05, 0.7, 0.72}, heading_rad}, kTable);
  }
  builder.add_box({middle + random.uniform(-0.4, 0.4) * along + Eigen::Vector3d(0, 0, 0.76),
                   {0.45, 0.35, random.uniform(0.25, 0.5)},
                   heading_rad + random.uniform(-0.6, 0.6)},
                  kCarton);
}

}  // namespace

Eigen::Vector3d room_size_m() {
  return {kLength_m, kWidth_m, kHeight_m};
}

PatchScene make_room(std::uint64_t seed) {
  Random random(seed, 1);
  SceneBuilder builder(seed);
  add_shell(builder);
  add_posters(builder, random);
  const auto about = [&](double value, double spread) {
    return value + random.uniform(-spread, spread);
  };
  // in the initial field of view
  builder.add_box({{about(5.6, 0.1), about(3.6, 0.2), 0}, {0.5, 1.6, 2.1}, 0}, kShelf);
  builder.add_box({{about(5.5, 0.1), about(-3.4, 0.2), 0}, {0.7, 1.2, 1.7}, 0}, kCabinet);
  builder.add_box({{about(4.6, 0.1), about(-1.9, 0.1), 0}, {0.6, 0.6, 1.1}, about(0.3, 0.2)},
                  kCarton);
  builder.add_box({{about(4.0, 0.1), about(2.3, 0.1), 0}, {0.7, 0.5, 0.9}, about(-0.4, 0.2)},
                  kCarton);
  builder.add_box({{about(5.2, 0.1), about(1.5, 0.1), 0}, {0.5, 0.8, 1.9}, about(0.2, 0.1)},
                  kCabinet);
  builder.add_box({{about(3.4, 0.1), about(-0.8, 0.1), 0}, {0.4, 0.5, 0.5}, about(0.7, 0.3)},
                  kCarton);
  builder.add_box({{about(3.2, 0.1), about(-2.9, 0.1), 0}, {0.5, 0.5, 0.8}, about(0.1, 0.3)},
                  kCarton);
  builder.add_box({{about(5.75, 0.05), about(-0.4, 0.3), 0}, {0.3, 1.0, 2.6}, 0}, kShelf);
  add_table(builder, {about(4.3, 0.1), about(0.3, 0.1)}, about(1.4, 0.15), random);
  add_table(builder, {about(3.6, 0.1), about(3.9, 0.1)}, about(0.1, 0.15), random);
  // along the other walls
  builder.add_box({{about(0.8, 0.4), about(4.6, 0.1), 0}, {1.8, 0.5, 2.0}, 0}, kShelf);
  builder.add_box({{about(-1.6, 0.3), about(-4.5, 0.1), 0}, {1.4, 0.6, 1.5}, 0}, kCabinet);
  builder.add_box({{about(1.2, 0.3), about(-4.4, 0.1), 0}, {0.8, 0.7, 1.2}, 0.2}, kCarton);
  builder.add_box({{about(-5.6, 0.1), about(2.0, 0.5), 0}, {0.5, 1.5, 2.1}, 0}, kShelf);
  builder.add_box({{about(-5.3, 0.1), about(-2.4, 0.5), 0}, {0.9, 0.9, 1.0}, 0.3}, kCarton);
  add_table(builder, {about(-3.9, 0.2), about(-3.9, 0.1)}, about(0, 0.2), random);
  return builder.scene();
}

}  // namespace stillkite
