#include "io/dataset/imu_description.hpp"

#include <array>
#include <string>

#include "io/config/config_binding.hpp"
#include "io/dataset/calibration.hpp"
#include "io/dataset/calibration_keys.hpp"

namespace stillkite {

std::optional<ImuDescription> read_imu_description(const std::filesystem::path& log) {
  const std::filesystem::path file = log.parent_path() / "sensor.yaml";
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  const ConfigNode root = read_yaml(file);
  const ConfigNode* const type = root.find("sensor_type");
  if (type == nullptr || type->text != "imu") return std::nullopt;
  ImuDescription out;
  if (const ConfigNode* T = root.find("T_BS")) out.body_from_sensor = read_transform(*T, "T_BS");
  const auto read_noise = [&](const std::string& key, std::optional<double>& value) {
    const Range range{.min = 0, .max = 1e3, .open_min = key.ends_with("density")};
    if (const ConfigNode* node = root.find(key)) read_value(*node, key, range, value);
  };
  read_noise("gyroscope_noise_density", out.noise.gyro_density);
  read_noise("gyroscope_random_walk", out.noise.gyro_bias_walk);
  read_noise("accelerometer_noise_density", out.noise.accel_density);
  read_noise("accelerometer_random_walk", out.noise.accel_bias_walk);
  reject_unread_keys(root, "", std::to_array<std::string_view>({"T_BS"}));
  return out;
}

}  // namespace stillkite
