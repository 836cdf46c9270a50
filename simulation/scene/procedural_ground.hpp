#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace stillkite {

/// An image of open country from above, CV_8UC1: fields with furrows and hedges, paths, bushes
/// with shadows and stones over a 1/f spectrum, so that there are edges and detail at every scale,
/// as in a photograph. The same for the same seed; sizes in texels, so it fits any height.
[[nodiscard]] cv::Mat procedural_ground(int width, int height, std::uint64_t seed);

}  // namespace stillkite
