// CPU time per image of the two renderers on the same flat ground, interleaved, and the difference
// of their images. PatchRenderer sees the ground as one patch with mirrored texture.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <vector>

#include "bench/processor_watch.hpp"
#include "simulation/camera_mount.hpp"
#include "simulation/render/patch_renderer.hpp"
#include "simulation/render/renderer.hpp"
#include "simulation/scene/procedural_ground.hpp"

namespace stillkite::bench {
namespace {

constexpr int kImages = 15;
constexpr double kHeight_m = 100;
constexpr double kFocal_px = 1152;

Camera camera_with(DistortionModel model) {
  Camera camera{.width_px = 1920,
                .height_px = 1080,
                .focal_x_px = kFocal_px,
                .focal_y_px = kFocal_px,
                .centre_x_px = 959.5,
                .centre_y_px = 539.5,
                .distortion = model};
  if (model == DistortionModel::radial_tangential) camera.coefficients = {-0.28, 0.07, 2e-4, 2e-5};
  return camera;
}

// Rectangle of two periods of the mirrored texture to each side of the origin.
PatchScene as_patch(const Scene& scene) {
  const GroundTexture::Level& finest = scene.ground->levels().front();
  const double texel_m = scene.ground->metres_per_texel();
  const double width_m = 2 * (finest.width - 1) * texel_m;
  const double height_m = 2 * (finest.height - 1) * texel_m;
  const Eigen::Vector3d first_texel(-0.25 * width_m, 0.25 * height_m, 0);
  return {.patches = {{.corner_in_world_m =
                           first_texel + Eigen::Vector3d(-2 * width_m, 2 * height_m, 0),
                       .right_in_world_m = {4 * width_m, 0, 0},
                       .down_in_world_m = {0, -4 * height_m, 0},
                       .texture = scene.ground}},
          .background_grey = scene.sky_grey};
}

double quantile(std::vector<double> values, double q) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void compare(const char* name, DistortionModel lens, double forward_tilt_deg, double texel_m,
             int supersampling) {
  const Camera camera = camera_with(lens);
  const Scene scene{.ground =
                        std::make_shared<GroundTexture>(procedural_ground(4000, 3000, 7), texel_m)};
  const PatchScene patch = as_patch(scene);
  const Renderer ground_renderer(camera, supersampling);
  const PatchRenderer patch_renderer(camera, supersampling);
  std::vector<double> ground_ms, patch_ms, differences;
  for (int k = 0; k < kImages; ++k) {
    const RigidTransform pose{camera_raised_forward(forward_tilt_deg).rotation,
                              {0.37 * k, -0.21 * k, kHeight_m}};
    ProcessorWatch watch;
    const cv::Mat a = ground_renderer.render(scene, pose);
    ground_ms.push_back(watch.lap_ms());
    const cv::Mat b = patch_renderer.render(patch, pose);
    patch_ms.push_back(watch.lap_ms());
    if (k > 0) continue;
    const cv::Mat difference = cv::abs(a - b);
    differences.assign(difference.begin<float>(), difference.end<float>());
  }
  fmt::print("{:28} {:>7} {:8.2f} {:8.2f} {:8.2f} {:10.3f} {:10.3f} {:8.2f}\n", name,
             supersampling * supersampling, quantile(ground_ms, 0.5), quantile(patch_ms, 0.5),
             quantile(patch_ms, 0.5) / quantile(ground_ms, 0.5), quantile(differences, 0.5),
             quantile(differences, 0.99), quantile(differences, 1));
}

}  // namespace
}  // namespace stillkite::bench

int main() try {
  using namespace stillkite;
  cv::setNumThreads(1);
  fmt::print("1920x1080, CPU time per image, medians of {} images; difference in grey values\n",
             bench::kImages);
  fmt::print("{:28} {:>7} {:>8} {:>8} {:>8} {:>10} {:>10} {:>8}\n", "view", "samples", "ground ms",
             "patch ms", "ratio", "median", "99 %", "largest");
  const double fine_m = bench::kHeight_m / bench::kFocal_px / 1.25;
  for (const int supersampling : {1, 2}) {
    bench::compare("nadir, 0.8 texels/pixel", DistortionModel::none, 5, 1.5625 * fine_m,
                   supersampling);
    bench::compare("nadir, 1.25 texels/pixel", DistortionModel::none, 5, fine_m, supersampling);
    bench::compare("45 deg", DistortionModel::none, 45, fine_m, supersampling);
    bench::compare("nadir, lens", DistortionModel::radial_tangential, 5, fine_m, supersampling);
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_render_ground: {}\n", error.what());
  return 1;
}
