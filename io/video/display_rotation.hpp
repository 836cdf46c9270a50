#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>

namespace stillkite {

/// Rotation of a video for display, from the display matrix of its track: pixel (x, y) is shown at
/// (a x + c y, b x + d y) (ISO/IEC 14496-12, 6.2.2). Nullopt without rotation. Throws InputError
/// with `name` if the rotation is not a multiple of 90 deg, or mirrored.
[[nodiscard]] std::optional<cv::RotateFlags> display_rotation(
    std::span<const std::int32_t, 9> matrix, const std::string& name);

}  // namespace stillkite
