#include "simulation/scene/scene_builder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/random.hpp"

namespace stillkite {
namespace {

Eigen::Vector3d towards(double heading_rad) {
  return {std::cos(heading_rad), std::sin(heading_rad), 0};
}

}  // namespace

std::shared_ptr<const GroundTexture> SceneBuilder::paint(double width_m, double height_m,
                                                         const Material& material) {
  constexpr int kMaxTexels = 2048;
  const auto texels = [&](double length_m) {
    return std::clamp(static_cast<int>(std::ceil(length_m / material.texel_m)) + 2, 16, kMaxTexels);
  };
  const std::uint64_t seed = Random(seed_, ++painted_).bits();
  return std::make_shared<GroundTexture>(
      surface_image(material.style, texels(width_m), texels(height_m), seed), material.texel_m);
}

void SceneBuilder::add_vertical_patch(const Eigen::Vector3d& foot, double facing_rad,
                                      double width_m, double height_m, const Material& material) {
  // right in the image = z x facing
  const Eigen::Vector3d right = towards(facing_rad + std::numbers::pi / 2);
  add({.corner_in_world_m = foot + height_m * Eigen::Vector3d::UnitZ() - 0.5 * width_m * right,
       .right_in_world_m = width_m * right,
       .down_in_world_m = -height_m * Eigen::Vector3d::UnitZ(),
       .texture = paint(width_m, height_m, material)});
}

void SceneBuilder::add_horizontal_patch(const Eigen::Vector3d& middle, double heading_rad,
                                        double length_m, double width_m, bool faces_up,
                                        const Material& material) {
  const Eigen::Vector3d right = length_m * towards(heading_rad);
  const double quarter = std::numbers::pi / 2;
  const Eigen::Vector3d down = width_m * towards(heading_rad + (faces_up ? -quarter : quarter));
  add({.corner_in_world_m = middle - 0.5 * right - 0.5 * down,
       .right_in_world_m = right,
       .down_in_world_m = down,
       .texture = paint(length_m, width_m, material)});
}

void SceneBuilder::add_box(const Box& box, const Material& material) {
  const double length_m = box.size_m.x();
  const double width_m = box.size_m.y();
  const double height_m = box.size_m.z();
  for (int side = 0; side < 4; ++side) {
    const double facing_rad = box.heading_rad + side * std::numbers::pi / 2;
    const bool end = side % 2 == 0;
    const Eigen::Vector3d foot =
        box.foot_in_world_m + 0.5 * (end ? length_m : width_m) * towards(facing_rad);
    add_vertical_patch(foot, facing_rad, end ? width_m : length_m, height_m, material);
  }
  const Eigen::Vector3d top = box.foot_in_world_m + height_m * Eigen::Vector3d::UnitZ();
  add_horizontal_patch(top, box.heading_rad, length_m, width_m, true, material);
  if (box.foot_in_world_m.z() > 0) {
    add_horizontal_patch(box.foot_in_world_m, box.heading_rad, length_m, width_m, false, material);
  }
}

}  // namespace stillkite
