#include "io/dataset/flight_inputs.hpp"

#include <fmt/core.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "geometry/angle.hpp"
#include "geometry/euler.hpp"
#include "io/dataset/calibration.hpp"
#include "io/dataset/euroc_dataset.hpp"
#include "io/dataset/sensor_checks.hpp"
#include "io/dataset/trajectory_file.hpp"

namespace stillkite {
namespace {

Calibration calibration_of(const CameraConfig& config) {
  Camera camera{.width_px = config.width_px,
                .height_px = config.height_px,
                .focal_x_px = config.focal_x_px,
                .focal_y_px = config.focal_y_px,
                .centre_x_px = config.centre_x_px,
                .centre_y_px = config.centre_y_px,
                .distortion = config.distortion};
  if (const auto wrong = coefficient_mismatch(config.distortion, config.coefficients.size())) {
    throw InputError("calibration.camera.coefficients: " + *wrong);
  }
  std::copy(config.coefficients.begin(), config.coefficients.end(), camera.coefficients.begin());
  check_camera(camera, "calibration.camera");
  return {.camera = camera};
}

Calibration find_calibration(const RunConfig& config, const std::optional<EurocDataset>& dataset,
                             const cv::Size& size) {
  if (config.calibration.path && config.calibration.camera) {
    throw InputError("calibration.path and calibration.camera are both set; keep one");
  }
  std::string origin = "calibration.camera";
  Calibration found;
  if (config.calibration.camera) {
    found = calibration_of(*config.calibration.camera);
  } else if (config.calibration.path || (dataset && dataset->calibration)) {
    const auto file = config.calibration.path ? *config.calibration.path : *dataset->calibration;
    origin = file.string();
    found = read_calibration(file);
  } else {
    throw InputError(config.source.path.string() +
                     ": no calibration found; set calibration.path or calibration.camera");
  }
  if (found.camera.width_px != size.width || found.camera.height_px != size.height) {
    throw InputError(fmt::format(
        "{}: calibration of {}x{} images, but {} has {}x{}; give the calibration of this "
        "resolution",
        origin, found.camera.width_px, found.camera.height_px, config.source.path.string(),
        size.width, size.height));
  }
  return found;
}

std::shared_ptr<const ImageMask> read_mask(const CalibrationConfig& config, const cv::Size& size) {
  if (!config.mask_path) return nullptr;
  const std::string name = config.mask_path->string();
  // imread prints a warning of its own for a missing file
  const bool exists = std::filesystem::exists(*config.mask_path);
  const cv::Mat grey = exists ? cv::imread(name, cv::IMREAD_GRAYSCALE) : cv::Mat();
  if (grey.empty()) {
    throw InputError("calibration.mask_path: " + name +
                     " is missing or not an image; give a PNG, black where the scene is hidden");
  }
  if (grey.size() != size) {
    throw InputError(fmt::format("calibration.mask_path: {} is {}x{}, but the images are {}x{}",
                                 name, grey.cols, grey.rows, size.width, size.height));
  }
  constexpr std::uint8_t kMaxBlack = 127;
  auto mask = std::make_shared<const ImageMask>(grey > kMaxBlack);
  if (mask->masked_ratio() == 1) {
    throw InputError("calibration.mask_path: " + name +
                     " is entirely black; paint the visible scene white");
  }
  return mask;
}

// R = [-y_B, -s x_B - c z_B, c x_B - s z_B], c = cos(down), s = sin(down): no roll.
Eigen::Quaterniond body_from_camera_looking_down(double down_deg) {
  const double c = std::cos(down_deg * kDegree);
  const double s = std::sin(down_deg * kDegree);
  Eigen::Matrix3d R;
  R.col(0) << 0, -1, 0;
  R.col(1) << -s, 0, -c;
  R.col(2) << c, 0, -s;
  return Eigen::Quaterniond(R);
}

RigidTransform mount_of(const MountConfig& mount, const Calibration& calibration) {
  const Eigen::Vector3d position = Eigen::Vector3d::Map(mount.position_m.data());
  if (mount.rotation_wxyz) {
    if (mount.down_deg) {
      throw InputError("mount.down_deg and mount.rotation_wxyz are both set; keep one");
    }
    const auto& [w, x, y, z] = *mount.rotation_wxyz;
    const Eigen::Quaterniond q(w, x, y, z);
    if (!(std::abs(q.norm() - 1.0) < 0.01)) {
      throw InputError(fmt::format("mount.rotation_wxyz: the norm is {:.4g}, must be 1", q.norm()));
    }
    return {q.normalized(), position};
  }
  if (!mount.down_deg && calibration.body_from_camera) {
    if (!position.isZero(0)) {
      throw InputError(
          "mount.position_m: the calibration has extrinsics; set mount.down_deg or "
          "mount.rotation_wxyz to replace them, or remove mount.position_m");
    }
    return *calibration.body_from_camera;
  }
  return {body_from_camera_looking_down(mount.down_deg.value_or(90.0)), position};
}

void read_truth(const RunConfig& config, const std::optional<EurocDataset>& dataset,
                FlightInputs& inputs) {
  std::optional<std::filesystem::path> file;
  if (config.truth.path) {
    file = find_trajectory(*config.truth.path);
  } else if (dataset) {
    file = dataset->truth;
  }
  if (!file) return;
  inputs.truth = read_trajectory(*file);
  for (StampedPose& pose : inputs.truth) {
    pose.world_from_body.translation.z() -= config.truth.ground_z_m;
  }
  if (dataset && dataset->camera_twists && file == dataset->truth) {
    inputs.twists_in_camera = read_twists(*dataset->camera_twists);
  }
}

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

InitialState initial_state_from_truth(const std::vector<StampedPose>& truth, Timestamp first) {
  if (truth.empty()) {
    throw InputError("initial.from_truth: no truth; set truth.path, or initial.height_m instead");
  }
  const double delay_s = seconds_between(first, truth.front().stamp);
  if (delay_s > 0.1 || first > truth.back().stamp) {
    throw InputError(fmt::format(
        "initial.from_truth: the truth covers {} s to {} s, the first frame is at {} s; "
        "choose source.start_s within the truth",
        to_seconds(truth.front().stamp), to_seconds(truth.back().stamp), to_seconds(first)));
  }
  std::size_t i = 0;
  while (i + 1 < truth.size() && truth[i + 1].stamp <= first) ++i;
  RigidTransform pose = truth[i].world_from_body;
  if (i + 1 < truth.size() && first > truth[i].stamp) {
    const double gap_s = seconds_between(truth[i].stamp, truth[i + 1].stamp);
    pose = interpolate(pose, truth[i + 1].world_from_body,
                       seconds_between(truth[i].stamp, first) / gap_s);
  }
  return {.world_from_body = pose, .scale = ScaleSource::initial_height};
}

InitialState initial_state(const RunConfig& config, const FlightInputs& inputs, Timestamp first) {
  if (config.initial.from_truth) {
    if (config.initial.height_m) {
      throw InputError(
          "initial.from_truth and initial.height_m are both set; keep one "
          "(initial.from_truth=false "
          "uses the height)");
    }
    return initial_state_from_truth(inputs.truth, first);
  }
  const SensorReadings readings = readings_between(inputs.sensors, first, first);
  InitialState initial;
  initial.world_from_body.rotation =
      readings.attitude.value_or(to_quaternion({.yaw_rad = config.initial.yaw_deg * kDegree,
                                                .pitch_rad = config.initial.pitch_deg * kDegree,
                                                .roll_rad = config.initial.roll_deg * kDegree}));
  initial.world_from_body.translation.z() = 1.0;
  if (config.initial.height_m) {
    initial.world_from_body.translation.z() = *config.initial.height_m;
    initial.scale = ScaleSource::initial_height;
  } else if (config.height.source == HeightSource::range && readings.height_m) {
    initial.world_from_body.translation.z() =
        height_of_body_m(*readings.height_m, ScaleSource::range, initial.world_from_body.rotation);
    initial.scale = ScaleSource::range;
  }
  return initial;
}

// Rejects a range finder log in millimetres, centimetres or feet.
void check_range(const FlightInputs& inputs, Timestamp first) {
  constexpr double kMaxHeightRatio = 3;
  const InitialState& initial = inputs.initial;
  const std::optional<double> reading = readings_between(inputs.sensors, first, first).height_m;
  if (inputs.sensors.height_source != ScaleSource::range || !reading ||
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

FlightInputs read_flight_inputs(const RunConfig& config, const Frame& first) {
  const std::optional<EurocDataset> dataset = find_euroc_dataset(config.source.path);
  const Calibration calibration = find_calibration(config, dataset, first.grey.size());
  FlightInputs inputs{.camera = calibration.camera,
                      .body_from_camera = mount_of(config.mount, calibration),
                      .mask = read_mask(config.calibration, first.grey.size())};
  read_truth(config, dataset, inputs);
  inputs.sensors = read_sensors(config);
  inputs.initial = initial_state(config, inputs, first.stamp);
  if (config.imu.path) {
    check_specific_forces(inputs.sensors.imu, "imu.path", inputs.initial.world_from_body.rotation,
                          first.stamp);
  }
  check_range(inputs, first.stamp);
  if (config.height.source == HeightSource::barometer) {
    align_barometer_to_initial_height(inputs.initial, first.stamp, inputs.sensors);
  }
  const RigidTransform world_from_camera = inputs.initial.world_from_body * inputs.body_from_camera;
  if (!(world_from_camera.translation.z() > 0)) {
    throw InputError(fmt::format(
        "initial camera height {:.3f} m must be above the ground (z = 0): check {}",
        world_from_camera.translation.z(),
        config.initial.from_truth ? "the truth's z" : "initial.height_m and mount.position_m"));
  }
  return inputs;
}

std::vector<std::filesystem::path> named_files(const RunConfig& config) {
  std::vector<std::filesystem::path> files{config.source.path};
  for (const auto& path :
       {config.calibration.path, config.calibration.mask_path, config.height.path, config.gyro.path,
        config.imu.path, config.attitude.path, config.acceleration.path,
        config.truth.path ? find_trajectory(*config.truth.path) : std::nullopt}) {
    if (path) files.push_back(*path);
  }
  return files;
}

}  // namespace stillkite
