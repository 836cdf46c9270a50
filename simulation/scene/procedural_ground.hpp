#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace stillkite {

/// Aerial image of open country, CV_8UC1, deterministic in the seed: fields with furrows and
/// hedges, paths, bushes with shadows and stones over 1/f noise. Edges and detail exist at every
/// scale, as in a photograph. Sizes are in texels and independent of the flight height.
[[nodiscard]] cv::Mat procedural_ground(int width, int height, std::uint64_t seed);

/// Image that repeats exactly every `period` texels along both axes, in GroundTexture's mirrored
/// repetition too: the cell, the first period / 2 + 1 texels of `image`, is mirrored. The side is
/// the largest of at most `max_side` texels. Precondition: `period` even and at least 4; `image`
/// contains the cell.
[[nodiscard]] cv::Mat repetitive_ground(const cv::Mat& image, int period, int max_side);

}  // namespace stillkite
