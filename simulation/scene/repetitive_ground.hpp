#pragma once

#include <opencv2/core/mat.hpp>

namespace stillkite {

/// Image that repeats exactly every `period` texels along both axes, in GroundTexture's mirrored
/// repetition too: the cell, the first period / 2 + 1 texels of `image`, is mirrored. The side is
/// the largest of at most `max_side` texels. Precondition: `period` even and at least 4; `image`
/// contains the cell.
[[nodiscard]] cv::Mat repetitive_ground(const cv::Mat& image, int period, int max_side);

}  // namespace stillkite
