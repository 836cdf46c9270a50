#pragma once

#include <numbers>

namespace stillkite {

/// One degree in radians.
inline constexpr double kDegree = std::numbers::pi / 180;

}  // namespace stillkite
