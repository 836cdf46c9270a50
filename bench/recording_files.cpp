#include "recording_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <stdexcept>

#include "io/results/output_file.hpp"
#include "io/results/output_folder.hpp"

namespace stillkite::bench {
namespace {

namespace fs = std::filesystem;

std::string row(Timestamp stamp, const Eigen::Ref<const Eigen::VectorXd>& values) {
  return fmt::format("{},{:.12g}\n", stamp.ns,
                     fmt::join(values.data(), values.data() + values.size(), ","));
}

std::string camera_yaml(const Recording& recording) {
  const Camera& camera = recording.camera;
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = recording.body_from_camera.rotation.toRotationMatrix();
  T.topRightCorner<3, 1>() = recording.body_from_camera.translation;
  const std::size_t used = camera.distortion == DistortionModel::radial_tangential ? 8 : 4;
  return fmt::format(
      "sensor_type: camera\n"
      "T_BS:\n  cols: 4\n  rows: 4\n  data: [{:.12g}]\n"
      "resolution: [{}, {}]\n"
      "camera_model: pinhole\n"
      "intrinsics: [{:.12g}, {:.12g}, {:.12g}, {:.12g}]\n"
      "distortion_model: {}\n"
      "distortion_coefficients: [{:.12g}]\n",
      fmt::join(T.data(), T.data() + T.size(), ", "), camera.width_px, camera.height_px,
      camera.focal_x_px, camera.focal_y_px, camera.centre_x_px, camera.centre_y_px,
      name_of(camera.distortion),
      fmt::join(camera.coefficients.begin(), camera.coefficients.begin() + used, ", "));
}

std::string imu_yaml(const ImuNoiseConfig& noise) {
  std::string text = "sensor_type: imu\n";
  const auto add = [&text](const char* key, const std::optional<double>& value) {
    if (value) text += fmt::format("{}: {}\n", key, *value);
  };
  add("gyroscope_noise_density", noise.gyro_density);
  add("gyroscope_random_walk", noise.gyro_bias_walk);
  add("accelerometer_noise_density", noise.accel_density);
  add("accelerometer_random_walk", noise.accel_bias_walk);
  return text;
}

std::string poses_csv(const std::vector<StampedPose>& poses) {
  std::string text =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z []\n";
  for (const StampedPose& at : poses) {
    const Eigen::Quaterniond& q = at.world_from_body.rotation;
    Eigen::Matrix<double, 7, 1> values;
    values << at.world_from_body.translation, q.w(), q.x(), q.y(), q.z();
    text += row(at.stamp, values);
  }
  return text;
}

std::string twists_csv(const std::vector<StampedTwist>& twists) {
  std::string text = "#timestamp [ns],vx,vy,vz [m/s camera frame],wx,wy,wz [rad/s camera frame]\n";
  for (const StampedTwist& at : twists) text += row(at.stamp, at.twist.vector());
  return text;
}

std::string imu_csv(const TimeSeries<Vector6d>& imu) {
  std::string text =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  for (std::size_t i = 0; i < imu.stamps.size(); ++i) text += row(imu.stamps[i], imu.values[i]);
  return text;
}

// Returns data.csv.
std::string write_images(const std::vector<RecordedImage>& images, const fs::path& folder) {
  std::string list = "#timestamp [ns],filename\n";
  for (const RecordedImage& image : images) {
    const std::string name = fmt::format("{:019}.png", image.stamp.ns);
    const std::string file = (folder / name).string();
    if (!cv::imwrite(file, image.grey, {cv::IMWRITE_PNG_COMPRESSION, 1})) {
      throw std::runtime_error(file + ": cannot be written; check the free disk space");
    }
    list += fmt::format("{},{}\n", image.stamp.ns, name);
  }
  return list;
}

}  // namespace

void write_recording(const Recording& recording, const fs::path& folder) {
  const cv::Mat& first = recording.images.front().grey;
  OutputFolder out(folder, recording.images.size() * first.total());
  const fs::path mav0 = out.part() / "mav0";
  const fs::path camera = mav0 / "cam0";
  fs::create_directories(camera / "data");
  write_file(camera / "data.csv", write_images(recording.images, camera / "data"));
  write_file(camera / "sensor.yaml", camera_yaml(recording));
  if (!recording.poses.empty()) {
    const fs::path truth = mav0 / "state_groundtruth_estimate0";
    fs::create_directories(truth);
    write_file(truth / "data.csv", poses_csv(recording.poses));
    if (!recording.twists_in_camera.empty()) {
      write_file(out.part() / "velocity.csv", twists_csv(recording.twists_in_camera));
    }
  }
  if (!recording.imu.stamps.empty()) {
    fs::create_directories(mav0 / "imu0");
    write_file(mav0 / "imu0/data.csv", imu_csv(recording.imu));
    write_file(mav0 / "imu0/sensor.yaml", imu_yaml(recording.imu_noise));
  }
  out.commit();
}

}  // namespace stillkite::bench
