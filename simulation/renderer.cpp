#include "simulation/renderer.hpp"

#include <algorithm>
#include <array>

#include "simulation/render_view.hpp"

namespace stillkite {
namespace {

// A picture is made in strips: what rows of a strip share on the ground then stays in the cache
// even where they run across the texture's rows.
constexpr int kStripWidth = 64;
}  // namespace

Renderer::Renderer(const Camera& camera, int supersampling)
    : camera_(camera),
      supersampling_(supersampling),
      bearings_(tabulate_bearings(camera, supersampling, kRowPadding)) {}

cv::Mat Renderer::render(const Scene& scene, const RigidTransform& world_from_camera,
                         const std::optional<VehiclePlacement>& vehicle) const {
  cv::Mat picture(camera_.height_px, camera_.width_px, CV_32FC1);
  if (!(world_from_camera.translation.z() > 0)) {
    picture.setTo(scene.sky_grey);
    return picture;
  }
  const double sample_focal_px = supersampling_ * std::min(camera_.focal_x_px, camera_.focal_y_px);
  const RenderView view = make_view(scene, world_from_camera, vehicle, sample_focal_px);
  const int width = bearings_.padded_width;
  for (int column = 0; column < width; column += kStripWidth) {
    render_strip(view, column, std::min(kStripWidth, width - column), picture);
  }
  return picture;
}

void Renderer::render_strip(const RenderView& frame_view, int first, int count,
                            cv::Mat& picture) const {
  RenderView view = frame_view;
  const int samples = bearings_.samples;
  constexpr int kMaxSamples = SampleBearings::kMaxSamples;
  std::array<float, kStripWidth> grey{};
  std::array<float, kMaxSamples * kStripWidth> heights{};
  std::array<float*, kMaxSamples> height_rows{};
  std::array<const float*, kMaxSamples> x_rows{};
  std::array<const float*, kMaxSamples> y_rows{};
  for (int sample = 0; sample < samples; ++sample) {
    height_rows[sample] = &heights[sample * kStripWidth];
  }
  for (int row = 0; row < camera_.height_px; ++row) {
    for (int sample = 0; sample < samples; ++sample) {
      x_rows[sample] = bearings_.x_row(row, sample) + first;
      y_rows[sample] = bearings_.y_row(row, sample) + (bearings_.separable ? 0 : first);
    }
    // the first row starts from z = 0, the others from the row above
    constexpr int kFirstSteps = 20;
    constexpr int kFollowingSteps = 2;
    view.relief_steps = row == 0 ? kFirstSteps : kFollowingSteps;
    render_row(view, {.count = count,
                      .samples = samples,
                      .bearing_x = x_rows.data(),
                      .bearing_y = y_rows.data(),
                      .even_y = bearings_.separable,
                      .ground_height_m = height_rows.data(),
                      .grey = grey.data()});
    std::copy_n(grey.data(), std::min(count, camera_.width_px - first),
                picture.ptr<float>(row) + first);
  }
}

}  // namespace stillkite
