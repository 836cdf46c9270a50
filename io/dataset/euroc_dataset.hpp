#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "geometry/time.hpp"

namespace stillkite {

struct StampedImage {
  Timestamp stamp;
  std::filesystem::path file;
};

/// The files of a recording in EuRoC ASL layout; what it does not have is empty.
struct EurocDataset {
  std::filesystem::path images_csv;                    ///< mav0/cam0/data.csv
  std::optional<std::filesystem::path> calibration;    ///< mav0/cam0/sensor.yaml
  std::optional<std::filesystem::path> truth;          ///< state_groundtruth_estimate0/data.csv
  std::optional<std::filesystem::path> camera_twists;  ///< velocity.csv beside mav0, or in it
};

/// The data set at a folder that is its root, its mav0 or its mav0/cam0; nothing at any other.
[[nodiscard]] std::optional<EurocDataset> find_euroc_dataset(const std::filesystem::path& folder);

/// The images that a cam0/data.csv lists, in data/ beside it. Throws InputError with file:line
/// on stamps out of order and on images that are not there.
[[nodiscard]] std::vector<StampedImage> read_image_list(const std::filesystem::path& images_csv);

/// The images of a folder in the order of the numbers in their names, one every 1 / rate_hz; a
/// number that is left out is an image that is missing. Throws InputError if there are none.
[[nodiscard]] std::vector<StampedImage> list_images(const std::filesystem::path& folder,
                                                    double rate_hz);

}  // namespace stillkite
