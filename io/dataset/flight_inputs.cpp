#include "io/dataset/flight_inputs.hpp"

#include <fmt/core.h>

#include "io/dataset/flight_camera.hpp"
#include "io/dataset/flight_sensors.hpp"
#include "io/dataset/initial_state.hpp"
#include "io/dataset/mask_file.hpp"
#include "io/dataset/trajectory_file.hpp"

namespace stillkite {

FlightInputs read_flight_inputs(const RunConfig& config, const Frame& first) {
  const std::optional<EurocDataset> dataset = find_euroc_dataset(config.source.path);
  const std::shared_ptr<const ImageMask> mask = read_mask(config.calibration, first.grey.size());
  const Calibration calibration = find_calibration(config, dataset, first.grey.size(), mask.get());
  FlightInputs inputs{.camera = calibration.camera,
                      .body_from_camera = mount_of(config.mount, calibration),
                      .mount_note = replaced_mount_note(config.mount, calibration),
                      .mask = mask};
  inputs.truth = read_ground_truth(config.truth, dataset);
  inputs.sensors = read_sensors(config, calibration.timeshift_cam_imu_s);
  inputs.initial = initial_state(config, inputs.truth, inputs.sensors, first.stamp);
  reconcile_with_initial_state(config, inputs.initial, first.stamp, inputs.sensors);
  const RigidTransform world_from_camera = inputs.initial.world_from_body * inputs.body_from_camera;
  if (!(world_from_camera.translation.z() > 0)) {
    throw InputError(fmt::format(
        "initial camera height {:.3f} m must be above the ground (z = 0): check {}",
        world_from_camera.translation.z(),
        config.initial.from_truth ? "the truth's z, and truth.ground_z_m (the ground's z)"
                                  : "initial.height_m and mount.position_m"));
  }
  return inputs;
}

std::vector<std::filesystem::path> named_files(const RunConfig& config) {
  std::vector<std::filesystem::path> files{config.source.path};
  for (const auto& path :
       {config.calibration.path, config.calibration.mask_path, config.height.path, config.gyro.path,
        config.imu.path, config.attitude.path, config.acceleration.path,
        config.truth.path ? find_trajectory(*config.truth.path) : std::nullopt,
        config.truth.positions ? find_trajectory(*config.truth.positions) : std::nullopt,
        config.truth.velocity}) {
    if (path) files.push_back(*path);
  }
  return files;
}

}  // namespace stillkite
