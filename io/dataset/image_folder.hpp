#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "io/dataset/euroc_dataset.hpp"

namespace stillkite {

/// True for the extension of an image file that list_images reads.
[[nodiscard]] bool is_image(const std::filesystem::path& file);

/// Images of a folder in the order of the numbers in their names, 1 / rate_hz apart. A skipped
/// number, and a gap between names that are time stamps, are missing images. Hidden files are
/// ignored. Throws InputError if the folder has no image, without a rate, of several series of
/// images (left_1.png, right_1.png), or names that are time since 1970 at another rate.
[[nodiscard]] std::vector<StampedImage> list_images(const std::filesystem::path& folder,
                                                    std::optional<double> rate_hz);

}  // namespace stillkite
