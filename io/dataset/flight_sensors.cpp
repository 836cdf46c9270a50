#include "io/dataset/flight_sensors.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <optional>
#include <utility>

#include "io/dataset/sensor_checks.hpp"

namespace stillkite {
namespace {

// A range finder without an echo returns 0 or less. True if no valid reading is left.
bool remove_invalid_ranges(TimeSeries<double>& distances_m) {
  TimeSeries<double> valid;
  for (std::size_t i = 0; i < distances_m.stamps.size(); ++i) {
    if (!(distances_m.values[i] > 0)) continue;
    valid.stamps.push_back(distances_m.stamps[i]);
    valid.values.push_back(distances_m.values[i]);
  }
  distances_m = std::move(valid);
  return distances_m.stamps.empty();
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

}  // namespace

SensorLog read_sensors(const RunConfig& config) {
  SensorLog log;
  if (config.gyro.path && config.imu.path) {
    throw InputError(
        "gyro.path and imu.path are both set; keep one (imu.path includes the angular rates)");
  }
  if (config.gyro.path) log.angular_rate_in_body_rad_s = read_gyro(*config.gyro.path);
  if (config.imu.path) {
    const TimeSeries<Vector6d> all = read_imu(*config.imu.path);
    log.imu = reject_imu_outliers(all);
    log.rejected_imu_readings = all.stamps.size() - log.imu.stamps.size();
    if (log.imu.stamps.empty()) {
      throw InputError(config.imu.path->string() + ": all readings are zero");
    }
    log.angular_rate_in_body_rad_s.stamps = log.imu.stamps;
    for (const Vector6d& value : log.imu.values) {
      log.angular_rate_in_body_rad_s.values.emplace_back(value.head<3>());
    }
  }
  if (config.attitude.path) log.attitude = read_attitudes(*config.attitude.path);
  if (config.acceleration.path) log.acceleration = read_accelerations(*config.acceleration.path);
  if (config.height.path.has_value() != (config.height.source != HeightSource::none)) {
    throw InputError("height.source and height.path: set both or neither");
  }
  if (config.height.path) log.height_m = read_heights(*config.height.path);
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
  }
  check_range(sensors, initial, first);
  if (config.height.source == HeightSource::barometer) {
    align_barometer_to_initial_height(initial, first, sensors);
  }
}

}  // namespace stillkite
