#include "io/dataset/calibration.hpp"

#include <cstdlib>

#include "io/config/config_node.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

const char* const kEuroc = R"(%YAML:1.0
# General sensor definitions.
sensor_type: camera
T_BS:
  cols: 4
  rows: 4
  data: [0.0, -1.0, 0.0, 0.1,
         1.0, 0.0, 0.0, -0.2,
         0.0, 0.0, 1.0, 0.3,
         0.0, 0.0, 0.0, 1.0]
rate_hz: 20
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
)";

const char* const kKalibr = R"(cam0:
  T_cam_imu:
  - [0.0, 1.0, 0.0, 0.2]
  - [-1.0, 0.0, 0.0, 0.1]
  - [0.0, 0.0, 1.0, -0.3]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: []
  camera_model: pinhole
  distortion_coeffs: [0.01, -0.02, 0.003, -0.004]
  distortion_model: equidistant
  intrinsics: [461.6, 460.2, 363.0, 248.1]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
)";

const char* const kOpencv = R"(%YAML:1.0
---
calibration_time: "Mon"
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.3e+02, 0., 320.5, 0., 531., 2.4e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.6e-01, -4.6e-02, 1.8e-03, -3.1e-04, 2.5e-01 ]
)";

Calibration parse(const std::string& text) {
  return read_calibration(parse_yaml(text, "c.yaml", "/"));
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string error_of(const std::string& text) {
  try {
    (void)parse(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Calibration, ReadsEuroc) {
  const Calibration c = parse(kEuroc);
  const Camera expected{.width_px = 752,
                        .height_px = 480,
                        .focal_x_px = 458.654,
                        .focal_y_px = 457.296,
                        .centre_x_px = 367.215,
                        .centre_y_px = 248.375,
                        .distortion = DistortionModel::radial_tangential,
                        .coefficients = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}};
  EXPECT_EQ(c.camera, expected);
  ASSERT_TRUE(c.body_from_camera.has_value());
  // x axis of the camera = y axis of the body
  EXPECT_LT(
      (*c.body_from_camera * Eigen::Vector3d::UnitX() - Eigen::Vector3d(0.1, 0.8, 0.3)).norm(),
      1e-12);
}

TEST(Calibration, ReadsKalibrAndInvertsExtrinsics) {
  const Calibration c = parse(kKalibr);
  EXPECT_EQ(c.camera.distortion, DistortionModel::equidistant);
  EXPECT_EQ(c.camera.coefficients, (std::array<double, 8>{0.01, -0.02, 0.003, -0.004}));
  EXPECT_EQ(c.camera.focal_y_px, 460.2);
  ASSERT_TRUE(c.body_from_camera.has_value());
  // T_cam_imu is the inverse of T_BS above
  EXPECT_LT(
      (*c.body_from_camera * Eigen::Vector3d::UnitX() - Eigen::Vector3d(0.1, 0.8, 0.3)).norm(),
      1e-12);
  EXPECT_EQ(parse(with(kKalibr, "equidistant", "radtan")).camera.distortion,
            DistortionModel::radial_tangential);
  EXPECT_EQ(parse(with(kKalibr, "equidistant", "none")).camera.distortion, DistortionModel::none);
}

TEST(Calibration, ReadsOpencvWithFourFiveAndEightCoefficients) {
  const Calibration five = parse(kOpencv);
  EXPECT_EQ(five.camera.width_px, 640);
  EXPECT_EQ(five.camera.focal_x_px, 530);
  EXPECT_EQ(five.camera.centre_y_px, 240);
  EXPECT_EQ(five.camera.coefficients,
            (std::array<double, 8>{-0.26, -0.046, 0.0018, -0.00031, 0.25}));
  EXPECT_FALSE(five.body_from_camera.has_value());

  const std::string old = "[ -2.6e-01, -4.6e-02, 1.8e-03, -3.1e-04, 2.5e-01 ]";
  EXPECT_EQ(
      parse(with(with(kOpencv, old, "[1, 2, 3, 4]"), "rows: 5", "rows: 4")).camera.coefficients,
      (std::array<double, 8>{1, 2, 3, 4}));
  EXPECT_EQ(parse(with(with(kOpencv, old, "[1,2,3,4,5,6,7,8]"), "rows: 5", "rows: 8"))
                .camera.coefficients,
            (std::array<double, 8>{1, 2, 3, 4, 5, 6, 7, 8}));
  const std::string fisheye = with(with(kOpencv, old, "[1, 2, 3, 4]"), "rows: 5", "rows: 4");
  EXPECT_EQ(parse(fisheye + "fisheye_model: 1\n").camera.distortion, DistortionModel::equidistant);
}

TEST(Calibration, ErrorsNameLocationKeyAndRemedy) {
  EXPECT_EQ(error_of("a: 1\n"),
            "c.yaml: no camera calibration; supported formats: EuRoC sensor.yaml (key intrinsics), "
            "Kalibr camchain (cam0), OpenCV (camera_matrix)");
  EXPECT_EQ(error_of(with(kEuroc, "resolution: [752, 480]\n", "")),
            "c.yaml:3:1: key 'resolution' is missing");
  EXPECT_EQ(error_of(with(kEuroc, "458.654", ".nan")),
            "c.yaml:14:14: intrinsics: '.nan' is not a finite number");
  EXPECT_EQ(error_of(with(kEuroc, "458.654", "-458")),
            "c.yaml: focal lengths -458, 457.296 px must be positive (and below 1e6)");
  EXPECT_EQ(error_of(with(kEuroc, "[752, 480]", "[0, 480]")),
            "c.yaml:12:14: resolution: 0 is out of range, allowed: [1, 100000]");
  EXPECT_EQ(error_of(with(kEuroc, "pinhole", "omni")),
            "c.yaml:13:1: camera_model: 'omni' is not one of pinhole");
  EXPECT_EQ(error_of(with(kEuroc, "1.0, 0.0, 0.0, -0.2", "2.0, 0.0, 0.0, -0.2")),
            "c.yaml:4:1: T_BS: not a rigid transform: the rotation must be orthonormal and "
            "right-handed, the last row 0 0 0 1");
  EXPECT_EQ(error_of(with(kEuroc, "367.215", "3672.15")),
            "c.yaml: principal point 3672.15, 248.375 px is outside the 752 x 480 image; give "
            "it in pixels of this resolution");
  EXPECT_EQ(error_of(with(kEuroc, "458.654", "0.61")),
            "c.yaml: focal lengths 0.61, 457.296 px are below 10 % of the image size 752 x 480; "
            "give them in pixels of this resolution");
  EXPECT_EQ(error_of(with(kKalibr, "0.01, ", "")),
            "c.yaml:9:3: cam0.distortion_coeffs: 3 coefficients, expected 4 for equidistant");
  EXPECT_EQ(error_of(with(kOpencv, "rows: 5", "rows: 6")),
            "c.yaml:11:1: distortion_coefficients: 5 numbers for a 6 x 1 matrix");
  EXPECT_EQ(error_of(with(kOpencv, "531.", "531., 2.")),
            "c.yaml:6:1: camera_matrix: 10 numbers for a 3 x 3 matrix");
}

TEST(Calibration, ReadsRealDataSets) {
  const char* data = std::getenv("STILLKITE_DATA");
  if (data == nullptr || *data == '\0') GTEST_SKIP() << "STILLKITE_DATA is not set";
  for (const char* name : {"flight_mat", "handheld_plane", "road_forward", "hover_static"}) {
    const auto file = std::filesystem::path(data) / name / "mav0/cam0/sensor.yaml";
    const Calibration c = read_calibration(file);
    EXPECT_GT(c.camera.width_px, 0) << name;
    EXPECT_TRUE(c.body_from_camera.has_value()) << name;
  }
}

}  // namespace
}  // namespace stillkite
