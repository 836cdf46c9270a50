#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>

namespace stillkite {

/// Orientation of an image file in JPEG, PNG, WebP or TIFF format, 1 to 8 (EXIF 2.32, tag 0x0112);
/// 1, upright, without a valid tag.
[[nodiscard]] int exif_orientation(std::span<const unsigned char> file);

[[nodiscard]] bool is_tiff(std::span<const unsigned char> file);

/// Rotation that shows a stored image of orientation 3, 6 or 8 upright.
[[nodiscard]] cv::RotateFlags exif_rotation(int orientation);

/// Throws InputError with `name` if the orientation is mirrored.
void reject_mirrored(int orientation, const std::string& name);

}  // namespace stillkite
