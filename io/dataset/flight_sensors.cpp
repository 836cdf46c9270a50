#include "io/dataset/flight_sensors.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/median.hpp"
#include "io/config/config_values.hpp"
#include "io/dataset/imu_description.hpp"
#include "io/dataset/interpolation_noise.hpp"
#include "io/dataset/sensor_checks.hpp"

namespace stillkite {
namespace {

// A range finder without an echo returns 0 or less. True if no valid reading is left.
bool remove_invalid_ranges(TimeSeries<double>& distances_m) {
  TimeSeries<double> valid{.stamps = {}, .values = {}, .max_gap_s = distances_m.max_gap_s};
  for (std::size_t i = 0; i < distances_m.stamps.size(); ++i) {
    if (!(distances_m.values[i] > 0)) continue;
    valid.stamps.push_back(distances_m.stamps[i]);
    valid.values.push_back(distances_m.values[i]);
  }
  distances_m = std::move(valid);
  return distances_m.stamps.empty();
}

// Rejects a range finder log in millimetres that sets the initial height.
void check_distances(const std::vector<double>& distances_m) {
  constexpr double kMaxDistance_m = 3000;
  if (distances_m.empty()) return;
  std::vector<double> values = distances_m;
  const double distance_m = upper_median(values);
  if (distance_m <= kMaxDistance_m) return;
  throw InputError(fmt::format(
      "height.path: the median distance is {:.4g} m, expected below {} m; give it in metres, or "
      "set initial.height_m",
      distance_m, kMaxDistance_m));
}

// Rejects a range finder log in millimetres, centimetres or feet.
void check_range(const SensorLog& sensors, const InitialState& initial, Timestamp first) {
  constexpr double kMaxHeightRatio = 3;
  const std::optional<double> reading = readings_between(sensors, first, first).height_m;
  if (sensors.height_source != ScaleSource::range || !reading ||
      initial.scale != ScaleSource::initial_height) {
    return;
  }
  const double height_m =
      height_of_body_m(*reading, ScaleSource::range, initial.world_from_body.rotation);
  const double ratio = height_m / initial.world_from_body.translation.z();
  if (!(ratio > 0) || (ratio < kMaxHeightRatio && ratio > 1 / kMaxHeightRatio)) return;
  throw InputError(fmt::format(
      "height.path: {:.4g} at the first frame disagrees with the initial height of {:.4g} m; give "
      "both in metres",
      *reading, initial.world_from_body.translation.z()));
}

// A barometer measures relative height: adds the offset to the initial height.
void align_barometer_to_initial_height(const InitialState& initial, Timestamp first,
                                       SensorLog& sensors) {
  if (initial.scale == ScaleSource::none) {
    throw InputError(
        "height.source: a barometer measures relative height; set initial.height_m too");
  }
  const std::optional<double> reading_m = readings_between(sensors, first, first).height_m;
  if (!reading_m) {
    throw InputError("height.path: no barometer reading at the time stamp of the first frame");
  }
  const double offset_m = initial.world_from_body.translation.z() - *reading_m;
  for (double& height_m : sensors.height_m.values) height_m += offset_m;
}

// Adds the offset to the stamps: log clock to image clock.
template <typename Value>
void shift(TimeSeries<Value>& series, double offset_s) {
  for (Timestamp& stamp : series.stamps) stamp.ns += std::llround(1e9 * offset_s);
}

// t_cam = t_imu - timeshift
double offset_s_of(const LogConfig& log, std::optional<double> timeshift_cam_imu_s) {
  return log.time_offset_s.value_or(-timeshift_cam_imu_s.value_or(0));
}

Eigen::Quaterniond body_from_sensor(const AxesLogConfig& log, const std::string& key,
                                    const std::optional<ImuDescription>& description) {
  if (log.rotation_wxyz) return unit_quaternion(*log.rotation_wxyz, key + ".rotation_wxyz");
  return description ? description->body_from_sensor.rotation : Eigen::Quaterniond::Identity();
}

TimeSeries<Eigen::Vector3d> read_body_rates(const AxesLogConfig& config,
                                            std::optional<double> timeshift_cam_imu_s) {
  TimeSeries<Eigen::Vector3d> rates = read_gyro(*config.path);
  shift(rates, offset_s_of(config, timeshift_cam_imu_s));
  const Eigen::Quaterniond rotation =
      body_from_sensor(config, "gyro", read_imu_description(*config.path));
  for (Eigen::Vector3d& rate : rates.values) rate = rotation * rate;
  return rates;
}

// A sensor.yaml states the noise at rest: it raises the defaults, which include vibration.
void read_body_imu(const ImuLogConfig& config, std::optional<double> timeshift_cam_imu_s,
                   const FusionConfig& defaults, SensorLog& log) {
  const TimeSeries<Vector6d> all = read_imu(*config.path);
  log.imu = reject_imu_outliers(all);
  log.rejected_imu_readings = all.stamps.size() - log.imu.stamps.size();
  if (log.imu.stamps.empty())
    throw InputError(config.path->string() + ": all readings are zero or equal");
  shift(log.imu, offset_s_of(config, timeshift_cam_imu_s));
  const std::optional<ImuDescription> description = read_imu_description(*config.path);
  const Eigen::Quaterniond rotation = body_from_sensor(config, "imu", description);
  log.angular_rate_in_body_rad_s.stamps = log.imu.stamps;
  log.angular_rate_in_body_rad_s.max_gap_s = log.imu.max_gap_s;
  for (Vector6d& value : log.imu.values) {
    value << rotation * value.head<3>(), rotation * value.tail<3>();
    log.angular_rate_in_body_rad_s.values.emplace_back(value.head<3>());
  }
  log.imu_noise = config.noise;
  if (!description) return;
  log.imu_lever_arm_m = description->body_from_sensor.translation.norm();
  const auto raise = [](std::optional<double>& value, std::optional<double> by_file,
                        double at_least) {
    if (!value && by_file) value = std::max(*by_file, at_least);
  };
  const ImuNoiseConfig& noise = description->noise;
  raise(log.imu_noise.gyro_density, noise.gyro_density, defaults.gyro_density);
  raise(log.imu_noise.gyro_bias_walk, noise.gyro_bias_walk, defaults.gyro_bias_walk);
  raise(log.imu_noise.accel_density, noise.accel_density, defaults.accel_density);
  raise(log.imu_noise.accel_bias_walk, noise.accel_bias_walk, defaults.accel_bias_walk);
}

TimeSeries<Eigen::Vector3d> forces_of(const TimeSeries<Vector6d>& imu) {
  TimeSeries<Eigen::Vector3d> forces{
      .stamps = imu.stamps, .values = {}, .max_gap_s = imu.max_gap_s};
  for (const Vector6d& value : imu.values) forces.values.emplace_back(value.tail<3>());
  return forces;
}

// Of logs whose rate does not resolve the motion between readings.
void add_interpolation_noise(const FusionConfig& defaults, SensorLog& log) {
  const auto add = [](std::optional<double>& density, double by_default,
                      const TimeSeries<Eigen::Vector3d>& readings) {
    const double own = density.value_or(by_default);
    const InterpolationNoise noise = interpolation_noise(readings, own);
    if (noise.density > 0) density = std::hypot(own, noise.density);
    return noise.sigma;
  };
  log.rate_sigma_rad_s =
      add(log.imu_noise.gyro_density, defaults.gyro_density, log.angular_rate_in_body_rad_s);
  if (!log.imu.stamps.empty()) {
    add(log.imu_noise.accel_density, defaults.accel_density, forces_of(log.imu));
  }
}

// world_from_body = world_from_sensor sensor_from_body
TimeSeries<Eigen::Quaterniond> read_body_attitudes(const AxesLogConfig& config) {
  TimeSeries<Eigen::Quaterniond> attitudes = read_attitudes(*config.path);
  shift(attitudes, offset_s_of(config, std::nullopt));
  const Eigen::Quaterniond sensor_from_body =
      body_from_sensor(config, "attitude", std::nullopt).conjugate();
  for (Eigen::Quaterniond& attitude : attitudes.values) attitude = attitude * sensor_from_body;
  return attitudes;
}

}  // namespace

Eigen::Quaterniond configured_body_from_sensor(const AxesLogConfig& log, const std::string& key) {
  return body_from_sensor(log, key, log.path ? read_imu_description(*log.path) : std::nullopt);
}

FusionConfig with_imu_noise(FusionConfig fusion, const ImuNoiseConfig& noise) {
  fusion.gyro_density = noise.gyro_density.value_or(fusion.gyro_density);
  fusion.gyro_bias_walk = noise.gyro_bias_walk.value_or(fusion.gyro_bias_walk);
  fusion.accel_density = noise.accel_density.value_or(fusion.accel_density);
  fusion.accel_bias_walk = noise.accel_bias_walk.value_or(fusion.accel_bias_walk);
  return fusion;
}

SensorLog read_sensors(const RunConfig& config, std::optional<double> timeshift_cam_imu_s) {
  SensorLog log;
  if (config.gyro.path && config.imu.path) {
    throw InputError(
        "gyro.path and imu.path are both set; keep one (imu.path includes the angular rates)");
  }
  if (config.gyro.path) {
    log.angular_rate_in_body_rad_s = read_body_rates(config.gyro, timeshift_cam_imu_s);
  }
  if (config.imu.path) {
    read_body_imu(config.imu, timeshift_cam_imu_s, config.navigator.fusion, log);
  }
  add_interpolation_noise(config.navigator.fusion, log);
  if (config.attitude.path) log.attitude = read_body_attitudes(config.attitude);
  if (config.acceleration.path) {
    log.acceleration = read_accelerations(*config.acceleration.path);
    shift(log.acceleration, offset_s_of(config.acceleration, std::nullopt));
  }
  if (config.height.path.has_value() != (config.height.source != HeightSource::none)) {
    throw InputError("height.source and height.path: set both or neither");
  }
  if (config.height.path) {
    log.height_m = read_heights(*config.height.path);
    shift(log.height_m, config.height.time_offset_s);
  }
  if (config.height.source == HeightSource::barometer) {
    log.height_source = ScaleSource::barometer;
  } else if (config.height.path && remove_invalid_ranges(log.height_m)) {
    throw InputError(config.height.path->string() + ": no distance above 0");
  }
  return log;
}

void reconcile_with_initial_state(const RunConfig& config, const InitialState& initial,
                                  Timestamp first, SensorLog& sensors) {
  if (config.imu.path) {
    check_specific_forces(sensors.imu, "imu.path", initial.world_from_body.rotation, first);
    check_rate_unit(sensors.imu, "imu.path");
  }
  check_range(sensors, initial, first);
  if (config.height.source == HeightSource::range && initial.scale != ScaleSource::initial_height) {
    check_distances(sensors.height_m.values);
  }
  if (config.height.source == HeightSource::barometer) {
    align_barometer_to_initial_height(initial, first, sensors);
  }
}

}  // namespace stillkite
