#include "simulation/sample_bearings.hpp"

#include <limits>
#include <opencv2/core/utility.hpp>
#include <string>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

constexpr int kMaxSupersampling = 4;
static_assert(kMaxSupersampling * kMaxSupersampling == SampleBearings::kMaxSamples);

// Position of a sample within its pixel, the pixel's centre being 0.
double offset(int sample, int supersampling) {
  return (sample + 0.5) / supersampling - 0.5;
}

SampleBearings tabulate_pinhole(const Camera& camera, const SampleBearings& layout) {
  SampleBearings bearings = layout;
  const int supersampling = layout.supersampling;
  const std::size_t width = bearings.padded_width;
  bearings.x.resize(supersampling * width);
  bearings.y.resize(static_cast<std::size_t>(camera.height_px) * supersampling);
  for (int sample = 0; sample < supersampling; ++sample) {
    const double within = offset(sample, supersampling);
    for (int column = 0; column < bearings.padded_width; ++column) {
      bearings.x[sample * width + column] =
          static_cast<float>((column + within - camera.centre_x_px) / camera.focal_x_px);
    }
    for (int row = 0; row < camera.height_px; ++row) {
      bearings.y[static_cast<std::size_t>(row) * supersampling + sample] =
          static_cast<float>((row + within - camera.centre_y_px) / camera.focal_y_px);
    }
  }
  return bearings;
}

SampleBearings tabulate_lens(const Camera& camera, const SampleBearings& layout) {
  SampleBearings bearings = layout;
  const int supersampling = layout.supersampling;
  const std::size_t samples = bearings.samples;
  const std::size_t width = bearings.padded_width;
  bearings.x.resize(samples * width * camera.height_px);
  bearings.y.resize(bearings.x.size());
  cv::parallel_for_(cv::Range(0, camera.height_px), [&](const cv::Range& rows) {
    for (int row = rows.start; row < rows.end; ++row) {
      for (std::size_t sample = 0; sample < samples; ++sample) {
        const double down = offset(static_cast<int>(sample) / supersampling, supersampling);
        const double right = offset(static_cast<int>(sample) % supersampling, supersampling);
        for (int column = 0; column < bearings.padded_width; ++column) {
          const std::optional<Eigen::Vector2d> bearing =
              undistort(camera, {column + right, row + down});
          const std::size_t at = (row * samples + sample) * width + column;
          // what the lens cannot see meets nothing: comparisons with NaN fail
          constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
          bearings.x[at] = bearing ? static_cast<float>(bearing->x()) : kNowhere;
          bearings.y[at] = bearing ? static_cast<float>(bearing->y()) : kNowhere;
        }
      }
    }
  });
  return bearings;
}

}  // namespace

const float* SampleBearings::x_row(int row, int sample) const {
  const std::size_t width = padded_width;
  if (separable) return &x[sample % supersampling * width];
  return &x[(static_cast<std::size_t>(row) * samples + sample) * width];
}

const float* SampleBearings::y_row(int row, int sample) const {
  const std::size_t width = padded_width;
  if (separable) return &y[row * supersampling + sample / supersampling];
  return &y[(static_cast<std::size_t>(row) * samples + sample) * width];
}

SampleBearings tabulate_bearings(const Camera& camera, int supersampling, int padding) {
  if (camera.width_px < 1 || camera.height_px < 1 || !(camera.focal_x_px > 0) ||
      !(camera.focal_y_px > 0)) {
    throw InputError("camera: width, height and focal lengths must be > 0");
  }
  if (supersampling < 1 || supersampling > kMaxSupersampling) {
    throw InputError("supersampling: must be 1 to 4, not " + std::to_string(supersampling));
  }
  const bool pinhole = camera.distortion == DistortionModel::none;
  const SampleBearings layout{.supersampling = supersampling,
                              .samples = supersampling * supersampling,
                              .padded_width = (camera.width_px + padding - 1) / padding * padding,
                              .separable = pinhole,
                              .x = {},
                              .y = {}};
  return pinhole ? tabulate_pinhole(camera, layout) : tabulate_lens(camera, layout);
}

}  // namespace stillkite
