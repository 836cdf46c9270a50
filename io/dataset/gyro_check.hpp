#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>

#include "io/dataset/rotation_comparison.hpp"

namespace stillkite {

/// Message if gyroscope and image rotations disagree and one hypothesis explains it: no signal,
/// degrees instead of radians, other axes, or a clock offset. Nullopt if the body hardly rotated or
/// no hypothesis explains the disagreement.
[[nodiscard]] std::optional<std::string> gyro_inconsistency(
    const TimeSeries<Eigen::Vector3d>& gyro, std::span<const ObservedRotation> observed);

}  // namespace stillkite
