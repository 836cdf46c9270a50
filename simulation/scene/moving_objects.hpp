#pragma once

#include <cstdint>
#include <vector>

#include "geometry/fields.hpp"
#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// People who walk to and fro before the camera. The defaults fit into the room, before its
/// furniture.
struct MovingObjectConfig {
  int count = 2;
  double width_m = 0.6;
  double height_m = 1.8;
  double distance_m = 2.7;
  double reach_m = 4;
  double speed_m_s = 1;

  static void fields(auto& self, auto&& field) {
    field("count", self.count, Range{1, 100}, "of people, or boats");
    field("width_m", self.width_m, Range{0.05, 100}, "of each");
    field("height_m", self.height_m, Range{0.05, 100}, "of each, from the floor");
    field("distance_m", self.distance_m, kPositive,
          "from the start along x; each goes 0.2 m behind the one before");
    field("reach_m", self.reach_m, kPositive, "of their way to either side of straight ahead");
    field("speed_m_s", self.speed_m_s, kNotNegative, "along y, at once the other way at the ends");
  }
};

struct MovingObject {
  Patch at_middle;          ///< of the way
  double way_before_m = 0;  ///< gone before time 0, from the middle towards +y
};

/// Textured upright rectangles, seen from their front only, which is towards -x: a thing that is
/// flat and does not swing its arms. The seed tells where on their ways they start.
[[nodiscard]] std::vector<MovingObject> make_moving_objects(const MovingObjectConfig& config,
                                                            std::uint64_t seed);

/// The scene with them where they are at that time: what is nearer hides what is behind. While the
/// shutter is open they stand still, 8 mm at 1 m/s and 8 ms.
[[nodiscard]] PatchScene with_moving_objects(PatchScene scene, const MovingObjectConfig& config,
                                             const std::vector<MovingObject>& moving_objects,
                                             double t_s);

}  // namespace stillkite
