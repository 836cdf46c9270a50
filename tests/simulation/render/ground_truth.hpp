#pragma once

#include <optional>

#include "geometry/camera.hpp"
#include "geometry/rigid_transform.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/relief.hpp"

namespace stillkite::test {

/// Ground point of a pixel by bisection on the ray in double precision, independent of the
/// renderer. Nullopt unless the ray points downwards.
inline std::optional<Eigen::Vector3d> ground_point(const Camera& camera,
                                                   const RigidTransform& world_from_camera,
                                                   const Relief* relief,
                                                   const Eigen::Vector2d& pixel) {
  const auto bearing = undistort(camera, pixel);
  if (!bearing) return std::nullopt;
  const Eigen::Vector3d ray = world_from_camera.rotation * bearing->homogeneous();
  if (ray.z() > -0.01) return std::nullopt;
  const Eigen::Vector3d& origin = world_from_camera.translation;
  const auto point = [&](double depth) { return Eigen::Vector3d(origin + depth * ray); };
  const auto above = [&](double depth) {
    const Eigen::Vector3d x = point(depth);
    return x.z() - (relief ? relief->height_m(x.x(), x.y()) : 0.0) > 0;
  };
  double high = 0;
  double low = 2 * origin.z() / -ray.z();
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (high + low);
    (above(middle) ? high : low) = middle;
  }
  return point(0.5 * (high + low));
}

inline Camera small_camera(DistortionModel model = DistortionModel::none) {
  Camera camera{.width_px = 237,  // not a multiple of the vector length
                .height_px = 160,
                .focal_x_px = 170,
                .focal_y_px = 168,
                .centre_x_px = 117.3,
                .centre_y_px = 81.2,
                .distortion = model};
  if (model == DistortionModel::radial_tangential) {
    camera.coefficients = {-0.28, 0.07, 2e-4, -1e-4};
  } else if (model == DistortionModel::equidistant) {
    camera.coefficients = {-0.013, 0.02, -0.012, 0.002};
  }
  return camera;
}

}  // namespace stillkite::test
