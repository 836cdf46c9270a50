#include "simulation/render/render_view.hpp"

#include <algorithm>
#include <cmath>

namespace stillkite {
namespace {

// Affine function with value `at_camera` at the camera and horizontal gradient `gradient`, at the
// point camera + s R b.
RayFunction ray_function(const Eigen::Matrix3d& world_from_camera, const Eigen::Vector2d& gradient,
                         double at_camera) {
  const Eigen::Vector3d row = world_from_camera.topRows<2>().transpose() * gradient;
  return {static_cast<float>(at_camera),
          {static_cast<float>(row.x()), static_cast<float>(row.y()), static_cast<float>(row.z())}};
}

void place_vehicle(const GroundTexture& paint, const VehiclePlacement& vehicle,
                   const Eigen::Matrix3d& R, const Eigen::Vector2d& camera, RenderView& view) {
  const Eigen::Vector2d ahead(std::cos(vehicle.heading_rad), std::sin(vehicle.heading_rad));
  const Eigen::Vector2d along = ahead * (2.0 / vehicle.length_m);
  const Eigen::Vector2d across = Eigen::Vector2d(ahead.y(), -ahead.x()) * (2.0 / vehicle.width_m);
  const Eigen::Vector2d from_vehicle = camera - vehicle.centre_in_world_m;
  view.vehicle_pairs = paint.pairs();
  view.vehicle_along = ray_function(R, along, along.dot(from_vehicle));
  view.vehicle_across = ray_function(R, across, across.dot(from_vehicle));
  view.vehicle_pitch = paint.levels()[0].pitch;
  view.vehicle_width = paint.levels()[0].width;
  view.vehicle_height = paint.levels()[0].height;
}

// Coordinates in outer radii. The shadow of the point at height z moves by z / tan(elevation)
// towards the sun.
void place_shadow(const ShadowPlacement& shadow, const Eigen::Matrix3d& R,
                  const Eigen::Vector2d& camera, RenderView& view) {
  const Eigen::Vector2d to_sun(std::cos(shadow.sun_azimuth_rad), std::sin(shadow.sun_azimuth_rad));
  const Eigen::Vector2d along = std::sin(shadow.sun_elevation_rad) / shadow.outer_radius_m * to_sun;
  const Eigen::Vector2d across = Eigen::Vector2d(-to_sun.y(), to_sun.x()) / shadow.outer_radius_m;
  const Eigen::Vector2d from_shadow = camera - shadow.centre_in_world_m;
  view.shadow_along = ray_function(R, along, along.dot(from_shadow));
  view.shadow_across = ray_function(R, across, across.dot(from_shadow));
  view.shadow_along_per_height =
      static_cast<float>(std::cos(shadow.sun_elevation_rad) / shadow.outer_radius_m);
  view.shadow_ramp =
      static_cast<float>(shadow.outer_radius_m / (shadow.outer_radius_m - shadow.inner_radius_m));
  view.shadow_darkening_ratio = static_cast<float>(shadow.darkening_ratio);
}

}  // namespace

RenderView make_view(const Scene& scene, const RigidTransform& world_from_camera,
                     const GroundObjects& objects, double sample_focal_px) {
  const Eigen::Matrix3d R = world_from_camera.rotation.toRotationMatrix();
  const Eigen::Vector2d camera = world_from_camera.translation.head<2>();
  const double height = world_from_camera.translation.z();
  const GroundTexture& ground = *scene.ground;

  RenderView view;
  view.sky_grey = static_cast<float>(scene.sky_grey);
  view.height_m = static_cast<float>(height);
  const Eigen::Vector3d down = -R.row(2);
  for (int k = 0; k < 3; ++k) view.down_per_bearing[k] = static_cast<float>(down[k]);

  const double texels_per_metre = 1.0 / ground.metres_per_texel();
  const Eigen::Vector2d texel = ground.texel_of(camera);
  const Eigen::Vector2d base(std::floor(texel.x()), std::floor(texel.y()));
  view.u = ray_function(R, {texels_per_metre, 0}, texel.x() - base.x());
  view.v = ray_function(R, {0, -texels_per_metre}, texel.y() - base.y());
  const auto within_period = [](double whole, int size) {
    return static_cast<float>(std::remainder(whole, 2.0 * (size - 1)));
  };
  view.base_u = within_period(base.x(), ground.levels()[0].width);
  view.base_v = within_period(base.y(), ground.levels()[0].height);
  // footprint of a sample at depth s in its longer direction: s^2 / (h f) metres
  view.texels_per_square_depth = static_cast<float>(texels_per_metre / (height * sample_focal_px));
  view.pairs = ground.pairs();
  view.levels = std::min<int>(static_cast<int>(ground.levels().size()), RenderView::kMaxLevels);
  for (int level = 0; level < view.levels; ++level) {
    view.level_scale[level] = std::ldexp(1.0F, -level);
    view.level_offset[level] = static_cast<std::int32_t>(ground.levels()[level].offset);
    view.level_width[level] = ground.levels()[level].width;
    view.level_height[level] = ground.levels()[level].height;
    view.level_pitch[level] = ground.levels()[level].pitch;
  }

  if (scene.relief) {
    const double cells_per_metre = 1.0 / scene.relief->cell_m();
    const auto cell = [&](double metres) {
      return std::remainder(metres * cells_per_metre, double{Relief::kCellsPerSide});
    };
    view.relief_words = scene.relief->words();
    view.relief_x = ray_function(R, {cells_per_metre, 0}, cell(camera.x()));
    view.relief_y = ray_function(R, {0, cells_per_metre}, cell(camera.y()));
    view.relief_metres_per_count = static_cast<float>(scene.relief->metres_per_count());
  }
  if (scene.vehicle && objects.vehicle) {
    place_vehicle(*scene.vehicle, *objects.vehicle, R, camera, view);
  }
  if (objects.shadow) place_shadow(*objects.shadow, R, camera, view);
  return view;
}

}  // namespace stillkite
