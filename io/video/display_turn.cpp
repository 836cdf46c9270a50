#include "io/video/display_turn.hpp"

#include <fmt/core.h>

#include <cmath>

#include "geometry/angle.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

std::optional<cv::RotateFlags> display_turn(std::span<const std::int32_t, 9> matrix,
                                            const std::string& name) {
  constexpr double kRounding = 0.01;
  const double a = matrix[0], b = matrix[1], c = matrix[3], d = matrix[4];
  const double straight = std::abs(a) + std::abs(d);
  const double across = std::abs(b) + std::abs(c);
  if (straight + across == 0) return std::nullopt;
  if (std::min(straight, across) > kRounding * std::max(straight, across)) {
    throw InputError(fmt::format(
        "{}: its images are marked to be shown turned by {:.1f} deg; only quarter turns can be "
        "made, take the mark out of the file",
        name, std::atan2(b, a) / kDegree));
  }
  if (a * d - b * c < 0) {
    throw InputError(name +
                     ": its images are marked to be shown mirrored, and what moves in a mirror "
                     "moves the other way; take the mark out of the file");
  }
  if (straight > across) return a > 0 ? std::nullopt : std::optional(cv::ROTATE_180);
  return b > 0 ? cv::ROTATE_90_CLOCKWISE : cv::ROTATE_90_COUNTERCLOCKWISE;
}

}  // namespace stillkite
