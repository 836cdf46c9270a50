#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flow/frame.hpp"
#include "flow/image_mask.hpp"
#include "geometry/camera.hpp"
#include "io/config/run_config.hpp"
#include "io/dataset/ground_truth.hpp"
#include "io/dataset/sensor_log.hpp"
#include "navigation/navigator.hpp"

namespace stillkite {

/// Inputs of a run in addition to the images.
struct FlightInputs {
  Camera camera;
  RigidTransform body_from_camera;
  std::optional<std::string> mount_note;  ///< replaced_mount_note
  std::shared_ptr<const ImageMask> mask;  ///< null: no mask
  InitialState initial;
  SensorLog sensors;
  GroundTruth truth;
};

/// Reads the files of the configuration. Throws InputError on an invalid file, a missing
/// calibration, a calibration or mask whose size differs from the first frame's, and an undefined
/// initial state.
[[nodiscard]] FlightInputs read_flight_inputs(const RunConfig& config, const Frame& first);

/// Input files of the configuration; a truth folder is replaced by its trajectory file.
[[nodiscard]] std::vector<std::filesystem::path> named_files(const RunConfig& config);

}  // namespace stillkite
