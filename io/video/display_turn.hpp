#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>

namespace stillkite {

/// How a film is to be turned when it is shown, by the matrix of its track (ISO/IEC 14496-12,
/// 6.2.2: the pixel (x, y) is shown at (a x + c y, b x + d y)); nothing where it stays as it is
/// coded. Throws InputError, with the film's `name`, where that is no quarter turn, or mirrored.
[[nodiscard]] std::optional<cv::RotateFlags> display_turn(std::span<const std::int32_t, 9> matrix,
                                                          const std::string& name);

}  // namespace stillkite
