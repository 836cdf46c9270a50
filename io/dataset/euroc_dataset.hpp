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

/// Files of a recording in EuRoC ASL layout; absent ones are nullopt.
struct EurocDataset {
  std::filesystem::path images_csv;                    ///< mav0/cam0/data.csv
  std::optional<std::filesystem::path> calibration;    ///< mav0/cam0/sensor.yaml
  std::optional<std::filesystem::path> truth;          ///< state_groundtruth_estimate0/data.csv
  std::optional<std::filesystem::path> camera_twists;  ///< velocity.csv next to mav0, or in it
};

/// Data set of a folder (its root, mav0 or mav0/cam0); nullopt for any other folder.
[[nodiscard]] std::optional<EurocDataset> find_euroc_dataset(const std::filesystem::path& folder);

/// Images listed in cam0/data.csv, in the folder data/ next to it; with `rate_hz` that far apart,
/// from the first stamp. Throws InputError "file:line: ..." on stamps that do not increase and on
/// missing images.
[[nodiscard]] std::vector<StampedImage> read_image_list(const std::filesystem::path& images_csv,
                                                        std::optional<double> rate_hz = {});

}  // namespace stillkite
