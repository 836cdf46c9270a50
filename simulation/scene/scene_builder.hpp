#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "simulation/scene/patch_scene.hpp"
#include "simulation/scene/surface_image.hpp"

namespace stillkite {

/// A box that stands upright; its length lies along x, turned by the heading.
struct Box {
  Eigen::Vector3d foot_in_world_m;  ///< middle of its underside
  Eigen::Vector3d size_m;           ///< length, width, height
  double heading_rad = 0;
};

struct Material {
  SurfaceStyle style;
  double texel_m = 0.004;
};

/// Puts a scene together. Every face gets an image of its own, no two alike.
class SceneBuilder {
 public:
  explicit SceneBuilder(std::uint64_t seed) : seed_(seed) {}

  void add(const Patch& patch) { scene_.patches.push_back(patch); }
  /// Its four sides and its top, and its underside where it stands above the ground.
  void add_box(const Box& box, const Material& material);
  /// An upright rectangle that faces the heading, from +x towards +y.
  void add_vertical_patch(const Eigen::Vector3d& foot_in_world_m, double faces_rad, double width_m,
                          double height_m, const Material& material);
  /// A level rectangle along x, turned by the heading, seen from above, or else from below.
  void add_level(const Eigen::Vector3d& middle_in_world_m, double heading_rad, double length_m,
                 double width_m, bool faces_up, const Material& material);

  /// An image for a rectangle of that size; a very large one repeats, mirrored.
  [[nodiscard]] std::shared_ptr<const GroundTexture> paint(double width_m, double height_m,
                                                           const Material& material);
  [[nodiscard]] const PatchScene& scene() const { return scene_; }

 private:
  std::uint64_t seed_;
  std::uint64_t painted_ = 0;
  PatchScene scene_;
};

}  // namespace stillkite
