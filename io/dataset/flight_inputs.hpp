#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "flow/frame.hpp"
#include "flow/image_mask.hpp"
#include "geometry/camera.hpp"
#include "io/config/run_config.hpp"
#include "io/dataset/sensor_log.hpp"
#include "navigation/navigator.hpp"

namespace stillkite {

/// All that a run needs beside the images, read from the files that the configuration names.
struct FlightInputs {
  Camera camera;
  RigidTransform body_from_camera;
  std::shared_ptr<const ImageMask> mask;  ///< none: all of the image shows the world
  InitialState initial;
  SensorLog sensors;
  std::vector<StampedPose> truth;              ///< empty: there is none
  std::vector<StampedTwist> twists_in_camera;  ///< of the truth; may be empty
};

/// Throws InputError where a file is wrong, where the calibration is of another resolution than the
/// first frame, or the mask is, where no calibration is found, and where the start is not
/// determined.
[[nodiscard]] FlightInputs read_flight_inputs(const RunConfig& config, const Frame& first);

/// The files that the configuration names, and those that a truth's folder stands for.
[[nodiscard]] std::vector<std::filesystem::path> named_files(const RunConfig& config);

}  // namespace stillkite
