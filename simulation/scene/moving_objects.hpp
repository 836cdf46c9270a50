#pragma once

#include <cstdint>
#include <vector>

#include "geometry/fields.hpp"
#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// Pedestrians that cross the field of view. The defaults fit the room scene, in front of its
/// furniture.
struct MovingObjectConfig {
  int count = 2;
  double width_m = 0.6;
  double height_m = 1.8;
  double distance_m = 2.7;
  double reach_m = 4;
  double speed_m_s = 1;

  static void fields(auto& self, auto&& field) {
    field("count", self.count, Range{1, 100}, "number of objects (people or boats)");
    field("width_m", self.width_m, Range{0.05, 100}, "width of an object");
    field("height_m", self.height_m, Range{0.05, 100}, "height of an object over the floor");
    field("distance_m", self.distance_m, kPositive,
          "distance of the first object's path from the origin along x; spacing 0.2 m");
    field("reach_m", self.reach_m, kPositive, "amplitude of the motion along y, about y = 0");
    field("speed_m_s", self.speed_m_s, kNonNegative,
          "constant speed along y; the direction reverses at the ends");
  }
};

struct MovingObject {
  Patch at_centre;            ///< at the centre of its path
  double initial_path_m = 0;  ///< path length at time 0, from the centre towards +y
};

/// Flat textured vertical rectangles, visible from -x only. The seed sets the initial positions.
[[nodiscard]] std::vector<MovingObject> make_moving_objects(const MovingObjectConfig& config,
                                                            std::uint64_t seed);

/// Scene with the objects at their positions at `t_s`, with occlusion by depth. No motion blur: an
/// object is at rest during the exposure, an error of 8 mm at 1 m/s and 8 ms.
[[nodiscard]] PatchScene with_moving_objects(PatchScene scene, const MovingObjectConfig& config,
                                             const std::vector<MovingObject>& moving_objects,
                                             double t_s);

}  // namespace stillkite
