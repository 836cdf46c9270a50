#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
}

#include <opencv2/core/mat.hpp>
#include <optional>

namespace stillkite {

/// Lines 0, 2, 4, ... (top) or 1, 3, 5, ... (bottom) of an interlaced image.
enum class Field { top, bottom };

/// Field exposed first, at the image's time stamp; nullopt for a progressive image.
[[nodiscard]] std::optional<Field> first_field(const AVFrame& image, AVFieldOrder track_order);

/// Replaces the lines of the other field, which is exposed half a frame interval later, by the mean
/// of the lines above and below. Lines of `kept` do not change.
void interpolate_other_field(cv::Mat& grey, Field kept);

}  // namespace stillkite
