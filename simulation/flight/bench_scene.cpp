#include "simulation/flight/bench_scene.hpp"

#include <memory>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/render/develop.hpp"
#include "simulation/render/renderer.hpp"
#include "simulation/scene/procedural_ground.hpp"

namespace stillkite {
namespace {

// Displacement over an interval for a twist that is constant in the moving frame:
// rotation exp([w]x t), translation = integral of exp([w]x s) v ds from 0 to t.
RigidTransform screw(const Twist& twist, double interval_s) {
  const Eigen::Vector3d rotation_rad = interval_s * twist.angular_rate_rad_s;
  return {so3_exp(rotation_rad),
          interval_s * (so3_left_jacobian(rotation_rad) * twist.velocity_m_s)};
}

}  // namespace

BenchScene make_bench_scene(const BenchMotion& motion, const cv::Mat& texture, std::uint64_t seed,
                            int supersampling) {
  constexpr double kTexelsPerPixel = 1.25;
  BenchScene scene;
  scene.camera = {.width_px = 1920,
                  .height_px = 1080,
                  .focal_x_px = motion.focal_px,
                  .focal_y_px = motion.focal_px,
                  .centre_x_px = 959.5,
                  .centre_y_px = 539.5};
  scene.interval_s = 1.0 / motion.frames_per_s;
  scene.world_from_previous = {
      to_quaternion({.yaw_rad = 0, .pitch_rad = 6 * kDegree, .roll_rad = 4 * kDegree}) *
          camera_looking_down(),
      {0, 0, motion.height_m}};
  scene.ground = ground_plane_in_camera(scene.world_from_previous);
  scene.twist_in_camera = {
      scene.world_from_previous.rotation.conjugate() * Eigen::Vector3d(motion.forward_m_s, 0, 0),
      motion.angular_rate_in_camera_rad_s};
  scene.world_from_current =
      scene.world_from_previous * screw(scene.twist_in_camera, scene.interval_s);

  const double metres_per_texel = motion.height_m / motion.focal_px / kTexelsPerPixel;
  // contrast at which the Cramer-Rao bound equals DESIGN's: 0.038 and 0.0016 m/s
  constexpr double kContrast = 0.45;
  cv::Mat procedural;
  if (texture.empty()) {
    procedural_ground(4096, 3072, seed)
        .convertTo(procedural, CV_8U, kContrast, 128 * (1 - kContrast));
  }
  const Scene world{.ground = std::make_shared<GroundTexture>(
                        texture.empty() ? procedural : texture, metres_per_texel)};
  const Renderer renderer(scene.camera, supersampling);
  scene.previous = renderer.render(world, scene.world_from_previous);
  scene.current = renderer.render(world, scene.world_from_current);
  return scene;
}

FramePair with_noise(const BenchScene& scene, double noise_grey, std::uint64_t seed) {
  const Exposure exposure{.noise_grey = noise_grey};
  return {develop(scene.previous, exposure, 2 * seed),
          develop(scene.current, exposure, 2 * seed + 1)};
}

}  // namespace stillkite
