#pragma once

#include <filesystem>
#include <optional>

#include "geometry/rigid_transform.hpp"
#include "io/config/input_config.hpp"

namespace stillkite {

/// Axes and noise of an IMU.
struct ImuDescription {
  RigidTransform body_from_sensor;
  ImuNoiseConfig noise;
};

/// EuRoC's imu0/sensor.yaml in the log's folder; nullopt if the folder has none, or that of another
/// sensor. Throws InputError on an invalid value and on a clock offset, which it cannot hold.
[[nodiscard]] std::optional<ImuDescription> read_imu_description(const std::filesystem::path& log);

}  // namespace stillkite
