#include "app/imu_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "app/interrupt.hpp"
#include "app/progress_bar.hpp"
#include "calibration/imu_alignment.hpp"
#include "geometry/angle.hpp"
#include "io/dataset/euroc_dataset.hpp"
#include "io/dataset/flight_camera.hpp"
#include "io/dataset/mask_file.hpp"
#include "io/dataset/sensor_log.hpp"
#include "io/results/json_text.hpp"
#include "io/results/output_file.hpp"
#include "io/video/frame_source.hpp"
#include "navigation/keyframe_features.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

double mean_variance(const FeatureObservation& feature) {
  return 0.5 * feature.covariance.trace();
}

// Features of both images by the number of their track; both lists ascend.
std::vector<BearingMatch> matches_of(const std::vector<FeatureObservation>& first,
                                     const std::vector<FeatureObservation>& second) {
  std::vector<BearingMatch> matches;
  for (const FeatureObservation& a : first) {
    const auto b = std::ranges::lower_bound(second, a.track_id, {}, &FeatureObservation::track_id);
    if (b == second.end() || b->track_id != a.track_id) continue;
    matches.push_back({a.bearing.homogeneous(), b->bearing.homogeneous(),
                       0.5 * (mean_variance(a) + mean_variance(*b))});
  }
  return matches;
}

// Pairs of images that follow each other: their errors are independent.
std::vector<ImagePair> image_pairs(FrameSource& source, const Camera& camera,
                                   const std::shared_ptr<const ImageMask>& mask,
                                   double lens_sigma_px) {
  constexpr double kInterval_s = 0.14;  // rotations of up to 3 Hz are resolved
  KeyframeFeatures features(camera, lens_sigma_px);
  ProgressBar progress("calibrate", source.expected());
  std::vector<ImagePair> pairs;
  std::vector<FeatureObservation> keyframe;
  std::optional<Timestamp> keyframe_stamp;
  while (std::optional<Frame> frame = source.next()) {
    if (interrupted()) throw Interrupted{};
    progress.step();
    frame->mask = mask;
    std::vector<FeatureObservation> tracked;
    if (keyframe_stamp) {
      tracked = features.track(*frame);
      if (seconds_between(*keyframe_stamp, frame->stamp) < kInterval_s) continue;
      pairs.push_back({*keyframe_stamp, frame->stamp, matches_of(keyframe, tracked)});
    }
    keyframe = features.take_keyframe(*frame).features;
    keyframe_stamp = keyframe.empty() ? std::nullopt : std::optional(frame->stamp);
  }
  return pairs;
}

struct GyroLog {
  std::vector<Timestamp> stamps;  // on the clock of the images, as configured
  std::vector<Eigen::Vector3d> rates_rad_s;
};

// In the sensor's own axes.
GyroLog read_gyro_log(const RunConfig& config, double configured_offset_s) {
  GyroLog log;
  if (config.imu.path) {
    const TimeSeries<Vector6d> imu = reject_imu_outliers(read_imu(*config.imu.path));
    log.stamps = imu.stamps;
    for (const Vector6d& reading : imu.values) log.rates_rad_s.emplace_back(reading.head<3>());
  } else {
    const TimeSeries<Eigen::Vector3d> gyro = read_gyro(*config.gyro.path);
    log = {gyro.stamps, gyro.values};
  }
  const Timestamp offset = from_seconds(configured_offset_s);
  for (Timestamp& stamp : log.stamps) stamp.ns += offset.ns;
  return log;
}

std::array<double, 4> wxyz(const Eigen::Quaterniond& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

json calibration_json(const ImuAlignment& alignment, const Eigen::Quaterniond& body_from_camera,
                      double configured_offset_s) {
  const Eigen::Matrix<double, 8, 1> sigmas = alignment.covariance.diagonal().cwiseSqrt();
  const Eigen::Quaterniond body_from_imu =
      (body_from_camera * alignment.imu_from_camera.conjugate()).normalized();
  const Eigen::Vector3d& bias = alignment.gyro_bias_rad_s;
  return {{"imu",
           {{"rotation_wxyz", wxyz(body_from_imu)},
            {"time_offset_s", configured_offset_s - alignment.time_offset_s}}},
          {"imu_from_camera_wxyz", wxyz(alignment.imu_from_camera)},
          {"gyro_bias_rad_s", {bias.x(), bias.y(), bias.z()}},
          {"sigma",
           {{"rotation_deg", sigmas.head<3>().norm() / kDegree},
            {"time_offset_s", sigmas(6)},
            {"gyro_bias_rad_s", sigmas.segment<3>(3).maxCoeff()}}},
          {"pairs", alignment.pairs},
          {"unit_variance", alignment.unit_variance}};
}

std::string numbers(const json& list) {
  std::string text;
  for (const json& one : list) {
    text += fmt::format("{}{:.6f}", text.empty() ? "" : ", ", one.get<double>());
  }
  return text;
}

std::string imu_yaml(const json& calibration, const char* section) {
  const json& sigma = calibration["sigma"];
  const double offset_s = calibration["imu"]["time_offset_s"].get<double>();
  return fmt::format(
      "# Result of stillkite calibrate by {} pairs of images; keys of stillkite run.\n"
      "{}:\n"
      "  rotation_wxyz: [{}]  # with the mount of this run; sigma {:.3f} deg\n"
      "  time_offset_s: {:.6f}  # sigma {:.6f}\n"
      "# Gyroscope bias, rad/s: [{}], sigma {:.6f}\n"
      "# With the IMU as the body, in the camera's calibration instead: timeshift_cam_imu: "
      "{:.6f},\n"
      "# rotation of T_imu_cam as quaternion (w, x, y, z): [{}]\n",
      calibration["pairs"].get<int>(), section, numbers(calibration["imu"]["rotation_wxyz"]),
      sigma["rotation_deg"].get<double>(), offset_s, sigma["time_offset_s"].get<double>(),
      numbers(calibration["gyro_bias_rad_s"]), sigma["gyro_bias_rad_s"].get<double>(), -offset_s,
      numbers(calibration["imu_from_camera_wxyz"]));
}

}  // namespace

json calibrate_imu(const RunConfig& config, const fs::path& out) {
  constexpr std::uintmax_t kMaxBytes = 1 << 20;  // of both results
  FrameSource source(config.source);
  const cv::Size size = source.first().grey.size();
  const auto dataset = find_euroc_dataset(config.source.path);
  const auto mask = read_mask(config.calibration, size);
  const Calibration calibration = find_calibration(config, dataset, size, mask.get());
  const Eigen::Quaterniond body_from_camera = mount_of(config.mount, calibration).rotation;
  const AxesLogConfig& log_config = config.imu.path ? config.imu : config.gyro;
  const double configured_offset_s =
      log_config.time_offset_s.value_or(-calibration.timeshift_cam_imu_s.value_or(0));
  const GyroLog log = read_gyro_log(config, configured_offset_s);
  const std::vector<ImagePair> pairs =
      image_pairs(source, calibration.camera, mask, config.navigator.lens_sigma_px);
  if (const auto problem = source.problem()) fmt::print(stderr, "stillkite: {}\n", *problem);
  const ImuAlignment alignment = align_imu(pairs, GyroReadings(log.stamps, log.rates_rad_s),
                                           {.gyro_density = config.imu.noise.gyro_density.value_or(
                                                config.navigator.fusion.gyro_density)});
  const json result = calibration_json(alignment, body_from_camera, configured_offset_s);
  prepare_output_folder(out, kMaxBytes);
  write_files(out, {{"imu.yaml", imu_yaml(result, config.imu.path ? "imu" : "gyro")},
                    {"calibration.json", json_text(result) + "\n"}});
  return result;
}

void print_imu_calibration(const json& calibration) {
  const json& sigma = calibration["sigma"];
  fmt::print("camera to IMU by {} pairs of images\n", calibration["pairs"].get<int>());
  fmt::print("  imu.rotation_wxyz  [{}]  sigma {:.3f} deg\n",
             numbers(calibration["imu"]["rotation_wxyz"]), sigma["rotation_deg"].get<double>());
  fmt::print("  imu.time_offset_s  {:.6f}  sigma {:.6f}\n",
             calibration["imu"]["time_offset_s"].get<double>(),
             sigma["time_offset_s"].get<double>());
  fmt::print("  gyroscope bias     [{}] rad/s  sigma {:.6f}\n",
             numbers(calibration["gyro_bias_rad_s"]), sigma["gyro_bias_rad_s"].get<double>());
}

}  // namespace stillkite
