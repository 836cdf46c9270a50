#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "bench/processor_watch.hpp"
#include "geometry/angle.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/hover/plant_config.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/patch_renderer.hpp"

namespace stillkite::bench {

/// Hover trajectory: horizontal circle with vertical sway about the initial pose, smooth entry.
struct Hover {
  static constexpr double kEntry_s = 1.5;

  RigidTransform world_from_initial;  ///< body pose
  double radius_m = 0;

  [[nodiscard]] RigidTransform world_from_body(double t_s) const {
    const double s = std::clamp(t_s / kEntry_s, 0.0, 1.0);
    const double offset_m = radius_m * s * s * (3 - 2 * s);
    const Eigen::Vector3d direction(std::cos(1.1 * t_s), std::sin(1.1 * t_s),
                                    0.6 * std::sin(0.7 * t_s + 1));
    const double yaw_rad = 3 * kDegree * std::sin(0.9 * t_s);
    return world_from_initial * RigidTransform{so3_exp({0, 0, yaw_rad}), offset_m * direction};
  }
};

/// Rendered image of the hover trials' camera with its CPU time.
struct View {
  cv::Mat grey;
  RigidTransform world_from_camera;
  double render_ms = 0, develop_ms = 0;
};

/// Image at `t_s`; `seed` of the image noise.
inline View view_of(const PatchScene& scene, const PatchRenderer& renderer, const Hover& hover,
                    double t_s, std::uint64_t seed) {
  const SimulatedCameraConfig camera = hover_camera();
  const RigidTransform mount = camera_raised_forward(camera.forward_tilt_deg);
  const auto pose = [&](double at_s) { return hover.world_from_body(at_s) * mount; };
  const Shutter shutter{.world_from_camera_at_opening = pose(t_s - 0.5 * camera.shutter_s),
                        .world_from_camera_at_closing = pose(t_s + 0.5 * camera.shutter_s),
                        .instants = camera.shutter_samples};
  View view{.grey = {}, .world_from_camera = pose(t_s)};
  ProcessorWatch watch;
  const cv::Mat light = renderer.render(scene, shutter);
  view.render_ms = watch.lap_ms();
  view.grey = develop(light, {.noise_grey = camera.noise_grey}, seed);
  view.develop_ms = watch.lap_ms();
  return view;
}

}  // namespace stillkite::bench
