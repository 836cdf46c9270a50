#include "simulation/render/renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core/utility.hpp>

#include "simulation/render/bearing_table.hpp"
#include "simulation/render/render_view.hpp"

namespace stillkite {
namespace {

// Rendering in vertical strips: the ground texels of neighbouring rows stay in the cache at any
// yaw.
constexpr int kStripWidth = 64;
constexpr int kMaxSamples = kMaxSupersampling * kMaxSupersampling;

// Offset of a sample from its pixel's centre, in pixels.
double offset(int sample, int supersampling) {
  return (sample + 0.5) / supersampling - 0.5;
}

}  // namespace

Renderer::Renderer(const Camera& camera, int supersampling, const LensError& lens_error)
    : camera_(camera),
      supersampling_(supersampling),
      padded_width_((camera.width_px + kRowPadding - 1) / kRowPadding * kRowPadding),
      pinhole_(camera.distortion == DistortionModel::none && lens_error.terms.empty()) {
  check_rendering(camera, supersampling);
  if (pinhole_) {
    tabulate_pinhole();
  } else {
    tabulate_lens(lens_error);
  }
}

void Renderer::tabulate_pinhole() {
  const std::size_t width = padded_width_;
  x_.resize(supersampling_ * width);
  y_.resize(static_cast<std::size_t>(camera_.height_px) * supersampling_);
  for (int sample = 0; sample < supersampling_; ++sample) {
    const double within = offset(sample, supersampling_);
    for (int column = 0; column < padded_width_; ++column) {
      x_[sample * width + column] =
          static_cast<float>((column + within - camera_.centre_x_px) / camera_.focal_x_px);
    }
    for (int row = 0; row < camera_.height_px; ++row) {
      y_[static_cast<std::size_t>(row) * supersampling_ + sample] =
          static_cast<float>((row + within - camera_.centre_y_px) / camera_.focal_y_px);
    }
  }
}

void Renderer::tabulate_lens(const LensError& lens_error) {
  const std::size_t samples = static_cast<std::size_t>(supersampling_) * supersampling_;
  const std::size_t width = padded_width_;
  x_.resize(samples * width * camera_.height_px);
  y_.resize(x_.size());
  cv::parallel_for_(cv::Range(0, camera_.height_px), [&](const cv::Range& rows) {
    for (int row = rows.start; row < rows.end; ++row) {
      for (std::size_t sample = 0; sample < samples; ++sample) {
        const double down = offset(static_cast<int>(sample) / supersampling_, supersampling_);
        const double right = offset(static_cast<int>(sample) % supersampling_, supersampling_);
        for (int column = 0; column < padded_width_; ++column) {
          const std::optional<Eigen::Vector2d> bearing =
              bearing_of(camera_, lens_error, {column + right, row + down});
          const std::size_t at = (row * samples + sample) * width + column;
          // outside the field of view: NaN fails the horizon comparison, so the sample is sky
          constexpr float kNoBearing = std::numeric_limits<float>::quiet_NaN();
          x_[at] = bearing ? static_cast<float>(bearing->x()) : kNoBearing;
          y_[at] = bearing ? static_cast<float>(bearing->y()) : kNoBearing;
        }
      }
    }
  });
}

cv::Mat Renderer::render(const Scene& scene, const RigidTransform& world_from_camera,
                         const GroundObjects& objects) const {
  cv::Mat image(camera_.height_px, camera_.width_px, CV_32FC1);
  render_rows(scene, world_from_camera, objects, {0, camera_.height_px}, image);
  return image;
}

void Renderer::render_rows(const Scene& scene, const RigidTransform& world_from_camera,
                           const GroundObjects& objects, const cv::Range& rows,
                           cv::Mat& image) const {
  if (!(world_from_camera.translation.z() > 0)) {
    image.rowRange(rows).setTo(scene.sky_grey);
    return;
  }
  const double sample_focal_px = supersampling_ * std::min(camera_.focal_x_px, camera_.focal_y_px);
  const RenderView view = make_view(scene, world_from_camera, objects, sample_focal_px);
  for (int column = 0; column < padded_width_; column += kStripWidth) {
    render_strip(view, column, std::min(kStripWidth, padded_width_ - column), rows, image);
  }
}

void Renderer::render_strip(const RenderView& frame_view, int first, int count,
                            const cv::Range& rows, cv::Mat& image) const {
  RenderView view = frame_view;
  const int samples = supersampling_ * supersampling_;
  const std::size_t width = padded_width_;
  std::array<float, kStripWidth> grey{};
  std::array<float, kMaxSamples * kStripWidth> heights{};
  std::array<float*, kMaxSamples> height_rows{};
  std::array<const float*, kMaxSamples> x_rows{};
  std::array<const float*, kMaxSamples> y_rows{};
  for (int sample = 0; sample < samples; ++sample) {
    height_rows[sample] = &heights[sample * kStripWidth];
    x_rows[sample] = &x_[sample % supersampling_ * width + first];
  }
  for (int row = rows.start; row < rows.end; ++row) {
    for (int sample = 0; sample < samples; ++sample) {
      const std::size_t at = (static_cast<std::size_t>(row) * samples + sample) * width + first;
      if (!pinhole_) x_rows[sample] = &x_[at];
      y_rows[sample] = pinhole_ ? &y_[row * supersampling_ + sample / supersampling_] : &y_[at];
    }
    // initial height: z = 0 in the first row, the row above in the others
    constexpr int kFirstSteps = 20;
    constexpr int kFollowingSteps = 2;
    view.relief_steps = row == rows.start ? kFirstSteps : kFollowingSteps;
    render_row(view, {.count = count,
                      .samples = samples,
                      .bearing_x = x_rows.data(),
                      .bearing_y = y_rows.data(),
                      .uniform_y = pinhole_,
                      .ground_height_m = height_rows.data(),
                      .grey = grey.data()});
    std::copy_n(grey.data(), std::min(count, camera_.width_px - first),
                image.ptr<float>(row) + first);
  }
}

}  // namespace stillkite
