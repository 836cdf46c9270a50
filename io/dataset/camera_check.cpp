#include "io/dataset/camera_check.hpp"

#include <fmt/core.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

// Order of fu, fv, cu, cv in which focal lengths are equal and the principal point is central, if
// neither holds for the given order; else empty.
std::string_view probable_order(const Camera& camera) {
  constexpr double kMaxAspect = 1.05, kMaxOffset = 0.15;
  const auto is_plausible = [&](double fu, double fv, double cu, double cv) {
    return fu < kMaxAspect * fv && fv < kMaxAspect * fu &&
           std::abs(cu / camera.width_px - 0.5) < kMaxOffset &&
           std::abs(cv / camera.height_px - 0.5) < kMaxOffset;
  };
  const double a = camera.focal_x_px, b = camera.focal_y_px;
  const double c = camera.centre_x_px, d = camera.centre_y_px;
  const bool has_equal_focal_lengths = a < kMaxAspect * b && b < kMaxAspect * a;
  if (has_equal_focal_lengths) return {};
  if (is_plausible(a, c, b, d)) return "fu, cu, fv, cv";
  if (is_plausible(c, d, a, b)) return "cu, cv, fu, fv";
  return {};
}

}  // namespace

void check_camera(const Camera& camera, const std::string& origin) {
  const auto require_that = [&](bool holds, const std::string& problem) {
    if (!holds) throw InputError(fmt::format("{}: {}", origin, problem));
  };
  constexpr double kMinFocalRatio = 0.1;
  const auto [w, h] = std::pair<double, double>(camera.width_px, camera.height_px);
  require_that(w > 0 && h > 0, fmt::format("resolution {} x {} is not positive", w, h));
  require_that(camera.focal_x_px > 0 && camera.focal_y_px > 0 && camera.focal_x_px < 1e6 &&
                   camera.focal_y_px < 1e6,
               fmt::format("focal lengths {}, {} px must be positive (and below 1e6)",
                           camera.focal_x_px, camera.focal_y_px));
  require_that(
      camera.focal_x_px > kMinFocalRatio * w && camera.focal_y_px > kMinFocalRatio * h,
      fmt::format("focal lengths {}, {} px are below 10 % of the image size {} x {}; give them in "
                  "pixels of this resolution",
                  camera.focal_x_px, camera.focal_y_px, w, h));
  require_that(
      camera.centre_x_px >= 0 && camera.centre_x_px <= w && camera.centre_y_px >= 0 &&
          camera.centre_y_px <= h,
      fmt::format("principal point {}, {} px is outside the {} x {} image; give it in pixels of "
                  "this resolution",
                  camera.centre_x_px, camera.centre_y_px, w, h));
  const std::string_view order = probable_order(camera);
  require_that(order.empty(),
               fmt::format("intrinsics {}, {}, {}, {} px are probably {}; the order is fu, fv, cu, "
                           "cv",
                           camera.focal_x_px, camera.focal_y_px, camera.centre_x_px,
                           camera.centre_y_px, order));
  for (const double c : camera.coefficients) {
    require_that(std::abs(c) < 1e6,
                 fmt::format("distortion coefficient {} must be finite and below 1e6", c));
  }
}

}  // namespace stillkite
