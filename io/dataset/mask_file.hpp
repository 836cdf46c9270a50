#pragma once

#include <memory>
#include <opencv2/core/types.hpp>

#include "flow/image_mask.hpp"
#include "io/config/camera_config.hpp"

namespace stillkite {

/// Mask of the images, black where the scene is hidden; null if the configuration names none.
/// Throws InputError if the file is missing, not an image, of another size or entirely black.
[[nodiscard]] std::shared_ptr<const ImageMask> read_mask(const CalibrationConfig& config,
                                                         const cv::Size& size);

}  // namespace stillkite
