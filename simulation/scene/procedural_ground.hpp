#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace stillkite {

/// Aerial image of open country, CV_8UC1, deterministic in the seed: fields with furrows and
/// hedges, paths, bushes with shadows and stones over 1/f noise. Edges and detail exist at every
/// scale, as in a photograph. Sizes are in texels and independent of the flight height.
[[nodiscard]] cv::Mat procedural_ground(int width, int height, std::uint64_t seed);

}  // namespace stillkite
