#pragma once

#include <opencv2/core/types.hpp>
#include <optional>
#include <string>

#include "io/config/run_config.hpp"
#include "io/dataset/calibration.hpp"
#include "io/dataset/euroc_dataset.hpp"

namespace stillkite {

class ImageMask;

/// Calibration with the file or section that it is from.
struct NamedCalibration {
  Calibration calibration;
  std::string origin;
};

/// Calibration of the configuration, else of the data set. Throws InputError without one or with
/// two.
[[nodiscard]] NamedCalibration configured_calibration(const RunConfig& config,
                                                      const std::optional<EurocDataset>& dataset);

/// The same, checked against the images. Throws InputError if its size differs from the images',
/// and if its lens model is not one-to-one where `mask` (may be null) does not hide the scene.
[[nodiscard]] Calibration find_calibration(const RunConfig& config,
                                           const std::optional<EurocDataset>& dataset,
                                           const cv::Size& size, const ImageMask* mask);

/// body_from_camera of the configuration, else of the calibration, else looking down. Throws
/// InputError on contradictory keys and a quaternion that is not of unit norm.
[[nodiscard]] RigidTransform mount_of(const MountConfig& mount, const Calibration& calibration);

/// Message if the configuration replaces a mount of the calibration that differs from it by more
/// than a mount measured by hand, 3 degrees.
[[nodiscard]] std::optional<std::string> replaced_mount_note(const MountConfig& mount,
                                                             const Calibration& calibration);

}  // namespace stillkite
