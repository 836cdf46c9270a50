#include "io/video/display_rotation.hpp"

#include <fmt/core.h>

#include <cmath>

#include "geometry/angle.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

std::optional<cv::RotateFlags> display_rotation(std::span<const std::int32_t, 9> matrix,
                                                const std::string& name) {
  constexpr double kRounding = 0.01;
  const double a = matrix[0], b = matrix[1], c = matrix[3], d = matrix[4];
  const double diagonal = std::abs(a) + std::abs(d);
  const double off_diagonal = std::abs(b) + std::abs(c);
  if (diagonal + off_diagonal == 0) return std::nullopt;
  if (std::min(diagonal, off_diagonal) > kRounding * std::max(diagonal, off_diagonal)) {
    throw InputError(fmt::format(
        "{}: the display matrix rotates by {:.1f} deg; only multiples of 90 deg are supported, "
        "remove the matrix from the file",
        name, std::atan2(b, a) / kDegree));
  }
  if (a * d - b * c < 0) {
    throw InputError(name +
                     ": the display matrix mirrors the images, which inverts the motion field; "
                     "remove the matrix from the file");
  }
  if (diagonal > off_diagonal) return a > 0 ? std::nullopt : std::optional(cv::ROTATE_180);
  return b > 0 ? cv::ROTATE_90_CLOCKWISE : cv::ROTATE_90_COUNTERCLOCKWISE;
}

}  // namespace stillkite
