#include "io/dataset/calibration.hpp"

#include <cstdlib>

#include "geometry/fields.hpp"
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
  const std::string coefficients = "[0.01, -0.02, 0.003, -0.004]";
  const std::string plain = with(kKalibr, "equidistant", "none");
  EXPECT_EQ(parse(with(plain, coefficients, "[]")).camera.distortion, DistortionModel::none);
  EXPECT_EQ(parse(with(plain, coefficients, "[0, 0]")).camera.distortion, DistortionModel::none);
  EXPECT_NE(error_of(plain).find("4 coefficients without a distortion model"), std::string::npos);
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

// The x axis of the camera is the y axis of the body, as in kEuroc.
TEST(Calibration, ReadsTheMountByEveryCommonName) {
  const Eigen::Vector3d expected(0.1, 0.8, 0.3);
  const auto tip = [](const std::string& text) -> Eigen::Vector3d {
    return parse(text).body_from_camera.value() * Eigen::Vector3d::UnitX();
  };
  for (const char* name : {"T_BC", "T_SC", "T_imu_cam", "T_imu_cam0", "body_T_cam0", "body_T_cam",
                           "imu_T_cam", "T_i_c", "Tbc", "IMU.T_b_c1", "body_from_camera"}) {
    EXPECT_LT((tip(with(kEuroc, "T_BS", name)) - expected).norm(), 1e-12) << name;
  }
  for (const char* name : {"T_cam_imu", "T_CB", "T_CS", "T_cam0_imu", "cam0_T_body", "Tcb"}) {
    EXPECT_LT((tip(with(kKalibr, "T_cam_imu", name)) - expected).norm(), 1e-12) << name;
  }
  const std::string rows = "[[0, -1, 0, 0.1], [1, 0, 0, -0.2], [0, 0, 1, 0.3], [0, 0, 0, 1]]";
  const std::string flat = "[0, -1, 0, 0.1, 1, 0, 0, -0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]";
  EXPECT_LT((tip(kOpencv + ("body_T_cam0: " + rows + "\n")) - expected).norm(), 1e-12);
  EXPECT_LT((tip(kOpencv + ("T_SC: " + flat + "\n")) - expected).norm(), 1e-12);
  EXPECT_NE(error_of(kOpencv + ("T_SC: " + flat + "\nT_BC: " + flat + "\n")).find("second mount"),
            std::string::npos);
}

TEST(Calibration, ReadsKalibrsTimeshift) {
  EXPECT_FALSE(parse(kKalibr).timeshift_cam_imu_s.has_value());
  EXPECT_EQ(parse(std::string(kKalibr) + "  timeshift_cam_imu: -0.06\n").timeshift_cam_imu_s,
            -0.06);
  EXPECT_NE(error_of(std::string(kKalibr) + "  timeshift_cam_imu: 6e7\n").find("out of range"),
            std::string::npos);
}

TEST(Calibration, RejectsUnreadKeysOfMountClockAndLens) {
  const auto error = [](const std::string& line) { return error_of(kOpencv + line + '\n'); };
  for (const char* line : {"T_W_C: [1]", "extrinsicRotation: [1, 0, 0]", "R_BC: [1]", "pitch: 30",
                           "q_BC: [1, 0, 0, 0]", "camera_position: [0, 0, 0]", "body_T_cam1: [1]",
                           "imu: {T_W_I: [1]}", "cams: [{T_ab: [1]}]"}) {
    EXPECT_NE(error(line).find("looks like a mount"), std::string::npos) << line << error(line);
    EXPECT_NE(error(line).find("mount.rotation_wxyz"), std::string::npos) << line;
  }
  for (const char* line : {"td: 0.02", "time_offset: -0.01", "image_delay: 0.003",
                           "temporal_offset: 0.1", "lag: 0.1", "cam_dt: 0.05"}) {
    EXPECT_NE(error(line).find("imu.time_offset_s"), std::string::npos) << line << error(line);
  }
  EXPECT_NE(error("line_delay: 3e-5").find("navigator.readout_s"), std::string::npos);
  for (const char* line : {"xi: 1.2", "distortion_parameters: {k1: 0.1}", "Camera.fx: 400",
                           "model_type: MEI", "thin_prism: [0.1, 0]", "mirror: true"}) {
    EXPECT_NE(error(line).find("looks like a lens"), std::string::npos) << line << error(line);
  }
  EXPECT_EQ(error("td: 0.02"),
            "c.yaml:16:1: td: looks like a clock offset, which is read from timeshift_cam_imu "
            "(t_imu = t_cam + timeshift); rename it, or remove it and set imu.time_offset_s");
  EXPECT_EQ(error("td: 0.0\nestimate_td: 0\nxi: 0\nmodel_type: PINHOLE\nnr_of_frames: 30\n"
                  "avg_reprojection_error: 0.2\nprojection_matrix: [1]\ncamera_name: a"),
            "accepted");
  EXPECT_EQ(error_of(kKalibr + std::string("cam1:\n  T_cn_cnm1: [[1]]\n")), "accepted");
}

TEST(Calibration, AcceptsZerosAfterTheLastCoefficient) {
  const auto set = [](DistortionModel model, std::vector<double> coefficients) {
    Camera camera;
    return set_distortion(camera, model, coefficients) ? std::array<double, 8>{}
                                                       : camera.coefficients;
  };
  const std::vector<double> eight{1, 2, 3, 4, 5, 6, 7, 8};
  for (const std::size_t n : {8u, 12u, 14u}) {
    std::vector<double> coefficients = eight;
    coefficients.resize(n, 0.0);
    EXPECT_EQ(set(DistortionModel::radial_tangential, coefficients),
              (std::array<double, 8>{1, 2, 3, 4, 5, 6, 7, 8}));
    if (n == 8) continue;
    coefficients.back() = 1e-3;
    Camera camera;
    EXPECT_NE(set_distortion(camera, DistortionModel::radial_tangential, coefficients)
                  .value_or("accepted")
                  .find("thin prism and tilted sensor"),
              std::string::npos);
  }
}

TEST(Calibration, ReadsOpencvXml) {
  const TemporaryFolder folder;
  const auto file = folder.file("c.xml", R"(<?xml version="1.0"?>
<opencv_storage>
<calibration_time>"Mon"</calibration_time>
<image_width>640</image_width>
<image_height>480</image_height>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows> <cols>3</cols> <dt>d</dt>
  <data> 5.3e+02 0. 320.5 0. 531. 2.4e+02 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id="opencv-matrix">
  <rows>5</rows> <cols>1</cols> <dt>d</dt>
  <data> -2.6e-01 -4.6e-02 1.8e-03 -3.1e-04 2.5e-01</data></distortion_coefficients>
</opencv_storage>
)");
  EXPECT_EQ(read_calibration(file).camera, parse(kOpencv).camera);
  const auto other = folder.file("o.xml", "<svg><a>1</a></svg>");
  EXPECT_NE(input_error_of(folder, [&] { (void)read_calibration(other); }).find("o.xml: "),
            std::string::npos);
}

TEST(Calibration, ErrorsNameLocationKeyAndRemedy) {
  EXPECT_EQ(error_of("a: 1\n"),
            "c.yaml: no camera calibration; supported formats: EuRoC sensor.yaml (key intrinsics), "
            "Kalibr camchain (cam0), OpenCV (camera_matrix); of other formats copy the values to "
            "calibration.camera: {width_px, height_px, focal_x_px, focal_y_px, centre_x_px, "
            "centre_y_px, distortion, coefficients}");
  EXPECT_EQ(error_of(with(kEuroc, "resolution: [752, 480]\n", "")),
            "c.yaml:3:1: key 'resolution' is missing");
  EXPECT_EQ(error_of(with(kEuroc, "458.654", ".nan")),
            "c.yaml:14:14: intrinsics: '.nan' is not a finite number");
  EXPECT_EQ(error_of(with(kEuroc, "458.654", "-458")),
            "c.yaml: focal lengths -458, 457.296 px must be positive (and below 1e6)");
  EXPECT_EQ(error_of(with(kEuroc, "[752, 480]", "[0, 480]")),
            "c.yaml:12:14: resolution: 0 is out of range, allowed: [1, 100000]");
  EXPECT_EQ(error_of(with(kEuroc, "pinhole", "omni")),
            "c.yaml:13:1: camera_model: 'omni' is not supported, only pinhole; calibrate with "
            "pinhole and "
            "radial-tangential or equidistant distortion");
  EXPECT_EQ(error_of(with(kEuroc, "1.0, 0.0, 0.0, -0.2", "2.0, 0.0, 0.0, -0.2")),
            "c.yaml:4:1: T_BS: not a rigid transform: the rotation must be orthonormal and "
            "right-handed, the last row 0 0 0 1");
  EXPECT_EQ(error_of(with(kEuroc, "367.215", "3672.15")),
            "c.yaml: principal point 3672.15, 248.375 px is outside the 752 x 480 image; give "
            "it in pixels of this resolution");
  EXPECT_EQ(error_of(with(kEuroc, "458.654", "0.61")),
            "c.yaml: focal lengths 0.61, 457.296 px are below 10 % of the image size 752 x 480; "
            "give them in pixels of this resolution");
  EXPECT_EQ(error_of(with(kEuroc, "458.654, 457.296, 367.215, 248.375",
                          "458.654, 367.215, 457.296, 248.375")),
            "c.yaml: intrinsics 458.654, 367.215, 457.296, 248.375 px are probably fu, cu, fv, cv; "
            "the order is fu, fv, cu, cv");
  EXPECT_NE(error_of(with(kEuroc, "458.654, 457.296, 367.215, 248.375",
                          "367.215, 248.375, 458.654, 457.296"))
                .find("probably cu, cv, fu, fv"),
            std::string::npos);
  EXPECT_EQ(error_of(with(kEuroc, "0.0, 1.0, 0.3", "0.0, 1.0, 300")),
            "c.yaml:4:1: T_BS: the translation of 300 m is above 20 m; give it in metres");
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
