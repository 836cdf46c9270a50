#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "simulation/scene/patch_scene.hpp"
#include "simulation/scene/surface_image.hpp"

namespace stillkite {

/// Box with a vertical axis.
struct Box {
  Eigen::Vector3d foot_in_world_m;  ///< centre of the bottom face
  Eigen::Vector3d size_m;           ///< length, width, height
  double heading_rad = 0;           ///< azimuth of the length, from +x towards +y
};

struct Material {
  SurfaceStyle style;
  double texel_m = 0.004;
};

/// Builds a scene; every face has a different texture.
class SceneBuilder {
 public:
  explicit SceneBuilder(std::uint64_t seed) : seed_(seed) {}

  void add(const Patch& patch) { scene_.patches.push_back(patch); }
  /// Four sides and the top; also the bottom if the box is above z = 0.
  void add_box(const Box& box, const Material& material);
  /// Vertical rectangle. `foot`: centre of the lower edge; `facing_rad`: azimuth of its front.
  void add_vertical_patch(const Eigen::Vector3d& foot_in_world_m, double facing_rad, double width_m,
                          double height_m, const Material& material);
  /// Horizontal rectangle, visible from above (`faces_up`) or from below.
  void add_horizontal_patch(const Eigen::Vector3d& middle_in_world_m, double heading_rad,
                            double length_m, double width_m, bool faces_up,
                            const Material& material);

  /// Texture for a rectangle; above 2048 texels it repeats, mirrored.
  [[nodiscard]] std::shared_ptr<const GroundTexture> paint(double width_m, double height_m,
                                                           const Material& material);
  [[nodiscard]] const PatchScene& scene() const { return scene_; }

 private:
  std::uint64_t seed_;
  std::uint64_t painted_ = 0;
  PatchScene scene_;
};

}  // namespace stillkite
