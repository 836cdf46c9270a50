#include "io/dataset/calibration.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "io/config/config_values.hpp"
#include "io/dataset/calibration_keys.hpp"
#include "io/dataset/camera_check.hpp"
#include "io/dataset/opencv_xml.hpp"

namespace stillkite {
namespace {

constexpr Range kPixels{.min = 1, .max = 100'000};

const ConfigNode& require(const ConfigNode& map, const std::string& key) {
  const ConfigNode* node = map.find(key);
  if (node == nullptr) {
    throw InputError(fmt::format("{}: key '{}' is missing", map.where(), key));
  }
  return *node;
}

DistortionModel distortion_named(const ConfigNode& node, const std::string& key) {
  constexpr auto kNames =
      std::to_array<std::string_view>({"none", "radial-tangential", "radtan", "plumb_bob",
                                       "rational_polynomial", "equidistant", "fisheye"});
  const std::size_t index = read_choice(node, key, kNames);
  return index == 0  ? DistortionModel::none
         : index < 5 ? DistortionModel::radial_tangential
                     : DistortionModel::equidistant;
}

void read_distortion(Camera& camera, DistortionModel model, const ConfigNode& node,
                     const std::string& key, const std::vector<double>& given) {
  if (const auto wrong = set_distortion(camera, model, given)) reject_value(node, key, *wrong);
}

// Matrix {rows, cols, data} of EuRoC and OpenCV.
std::vector<double> read_matrix(const ConfigNode& node, const std::string& key) {
  const std::vector<double> data = read_numbers(require(node, "data"), key + ".data", kAny);
  const long long rows = read_integer(require(node, "rows"), key + ".rows", kPixels);
  const long long cols = read_integer(require(node, "cols"), key + ".cols", kPixels);
  if (std::ssize(data) != rows * cols) {
    reject_value(node, key,
                 fmt::format("{} numbers for a {} x {} matrix", data.size(), rows, cols));
  }
  return data;
}

// Mount and clock, by any of their names; rejects other keys that look like these or like a lens.
void read_extrinsics(const ConfigNode& map, const std::string& prefix,
                     std::vector<std::string_view> lens_keys, Calibration& out) {
  constexpr Range kTimeshift_s{-10, 10};
  std::vector<std::string_view>& read = lens_keys;
  for (const auto& [key, value] : map.entries) {
    const MountKey mount = mount_key(key);
    if (key == "timeshift_cam_imu") {
      out.timeshift_cam_imu_s = read_number(value, prefix + key, kTimeshift_s);
    } else if (mount != MountKey::none) {
      if (out.body_from_camera) reject_value(value, prefix + key, "a second mount; keep one");
      const RigidTransform T = read_transform(value, prefix + key);
      out.body_from_camera = mount == MountKey::body_from_camera ? T : T.inverse();
    } else {
      continue;
    }
    read.push_back(key);
  }
  reject_unread_keys(map, prefix, read);
}

// Pinhole camera of EuRoC and Kalibr, which differ in the key of the coefficients.
Camera read_pinhole(const ConfigNode& root, const std::string& prefix,
                    const std::string& coefficients_key) {
  const ConfigNode& model_name = require(root, "camera_model");
  if (model_name.text != "pinhole") {
    reject_value(model_name, prefix + "camera_model",
                 fmt::format("'{}' is not supported, only pinhole; calibrate with pinhole and "
                             "radial-tangential or equidistant distortion",
                             model_name.text));
  }
  const auto resolution =
      read_numbers(require(root, "resolution"), prefix + "resolution", kPixels, 2);
  const auto intrinsics = read_numbers(require(root, "intrinsics"), prefix + "intrinsics", kAny, 4);
  Camera camera{.width_px = static_cast<int>(resolution[0]),
                .height_px = static_cast<int>(resolution[1]),
                .focal_x_px = intrinsics[0],
                .focal_y_px = intrinsics[1],
                .centre_x_px = intrinsics[2],
                .centre_y_px = intrinsics[3]};
  const auto model =
      distortion_named(require(root, "distortion_model"), prefix + "distortion_model");
  const ConfigNode* const node = root.find(coefficients_key);
  if (node != nullptr || model != DistortionModel::none) {
    (void)require(root, coefficients_key);
    read_distortion(camera, model, *node, prefix + coefficients_key,
                    read_numbers(*node, prefix + coefficients_key, kAny));
  }
  return camera;
}

// EuRoC, and Kalibr's cam0.
Calibration read_pinhole_file(const ConfigNode& map, const std::string& prefix,
                              const char* coefficients_key) {
  Calibration out{.camera = read_pinhole(map, prefix, coefficients_key)};
  read_extrinsics(
      map, prefix,
      {"camera_model", "resolution", "intrinsics", "distortion_model", coefficients_key}, out);
  return out;
}

Calibration read_opencv(const ConfigNode& root) {
  const ConfigNode& matrix = require(root, "camera_matrix");
  const std::vector<double> K = read_matrix(matrix, "camera_matrix");
  if (K.size() != 9 || K[1] != 0 || K[3] != 0 || K[6] != 0 || K[7] != 0 || K[8] != 1) {
    reject_value(matrix, "camera_matrix", "must be [fx, 0, cx, 0, fy, cy, 0, 0, 1]");
  }
  Camera camera{
      .width_px =
          static_cast<int>(read_integer(require(root, "image_width"), "image_width", kPixels)),
      .height_px =
          static_cast<int>(read_integer(require(root, "image_height"), "image_height", kPixels)),
      .focal_x_px = K[0],
      .focal_y_px = K[4],
      .centre_x_px = K[2],
      .centre_y_px = K[5]};
  DistortionModel model = DistortionModel::radial_tangential;
  if (const ConfigNode* name = root.find("distortion_model")) {
    model = distortion_named(*name, "distortion_model");
  } else if (const ConfigNode* flag = root.find("fisheye_model")) {
    constexpr auto kFlags = std::to_array<std::string_view>({"0", "false", "1", "true"});
    if (read_choice(*flag, "fisheye_model", kFlags) > 1) model = DistortionModel::equidistant;
  }
  const ConfigNode& node = require(root, "distortion_coefficients");
  read_distortion(camera, model, node, "distortion_coefficients",
                  read_matrix(node, "distortion_coefficients"));
  Calibration out{.camera = camera};
  read_extrinsics(root, "",
                  {"camera_matrix", "distortion_model", "fisheye_model", "distortion_coefficients"},
                  out);
  return out;
}

}  // namespace

Calibration read_calibration(const std::filesystem::path& file) {
  return read_calibration(is_xml(file) ? read_opencv_xml(file) : read_yaml(file));
}

Calibration read_calibration(const ConfigNode& root) {
  Calibration out;
  if (const ConfigNode* cam0 = root.find("cam0")) {
    out = read_pinhole_file(*cam0, "cam0.", "distortion_coeffs");
    reject_unread_keys(root, "", std::to_array<std::string_view>({"cam0"}));
  } else if (root.find("camera_matrix") != nullptr) {
    out = read_opencv(root);
  } else if (root.find("intrinsics") != nullptr) {
    out = read_pinhole_file(root, "", "distortion_coefficients");
  } else {
    throw InputError(
        root.origin +
        ": no camera calibration; supported formats: EuRoC sensor.yaml (key intrinsics), Kalibr "
        "camchain (cam0), OpenCV (camera_matrix); of other formats copy the values to "
        "calibration.camera: {width_px, height_px, focal_x_px, focal_y_px, centre_x_px, "
        "centre_y_px, distortion, coefficients}");
  }
  check_camera(out.camera, root.origin);
  return out;
}

RigidTransform read_transform(const ConfigNode& node, const std::string& key) {
  std::vector<double> data;
  if (node.kind == ConfigNode::Kind::map) {
    data = read_matrix(node, key);
  } else if (!node.items.empty() && node.items[0].kind == ConfigNode::Kind::list) {
    for (const ConfigNode& row : node.items) {
      const std::vector<double> numbers = read_numbers(row, key, kAny, 4);
      data.insert(data.end(), numbers.begin(), numbers.end());
    }
  } else {
    data = read_numbers(node, key, kAny);
  }
  if (data.size() != 16) reject_value(node, key, "expected a 4 x 4 matrix");
  const Eigen::Matrix4d T =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(data.data());
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const double orthonormality_error = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm();
  const bool is_last_row = (T.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < 1e-6;
  if (!(orthonormality_error < 1e-3) || !(R.col(0).cross(R.col(1)).dot(R.col(2)) > 0) ||
      !is_last_row) {
    reject_value(
        node, key,
        "not a rigid transform: the rotation must be orthonormal and right-handed, the last row "
        "0 0 0 1");
  }
  constexpr double kMaxTranslation_m = 20;
  if (const double length = T.topRightCorner<3, 1>().norm(); length > kMaxTranslation_m) {
    reject_value(node, key,
                 fmt::format("the translation of {:.4g} m is above {} m; give it in metres", length,
                             kMaxTranslation_m));
  }
  return {Eigen::Quaterniond(R).normalized(), T.topRightCorner<3, 1>()};
}

std::optional<std::string> set_distortion(Camera& camera, DistortionModel model,
                                          std::span<const double> coefficients) {
  const auto is_zero = [](double c) { return c == 0; };
  const bool is_equidistant = model == DistortionModel::equidistant;
  const std::size_t n = coefficients.size();
  const std::size_t most = model == DistortionModel::none ? 0 : is_equidistant ? 4 : 8;
  const auto used = coefficients.first(std::min(n, most));
  if (!std::ranges::all_of(coefficients.subspan(used.size()), is_zero)) {
    if (most == 0) {
      return fmt::format("{} coefficients without a distortion model; set distortion", n);
    }
    if (n == 12 || n == 14) {
      return fmt::format(
          "{} coefficients: thin prism and tilted sensor (the last {}) are not supported unless "
          "zero; calibrate with 8",
          n, n - most);
    }
  } else if (most == 0 || n == 4 || n == 12 || n == 14 || (!is_equidistant && (n == 5 || n == 8))) {
    camera.distortion = model;
    std::ranges::copy(used, camera.coefficients.begin());
    return std::nullopt;
  }
  return fmt::format("{} coefficients, expected {} for {}", n,
                     is_equidistant ? "4" : "4, 5 or 8 (12, 14: the last zero)", name_of(model));
}

}  // namespace stillkite
