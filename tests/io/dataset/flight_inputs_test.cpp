#include "io/dataset/flight_inputs.hpp"

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "geometry/angle.hpp"
#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

class Inputs : public testing::Test {
 protected:
  Inputs() { config.calibration.camera = CameraConfig{}; }

  FlightInputs read() { return read_flight_inputs(config, first); }
  std::string error() {
    return input_error_of(folder, [&] { (void)read(); });
  }

  TemporaryFolder folder;
  RunConfig config;
  Frame first{.stamp = from_seconds(1.5), .grey = cv::Mat(1080, 1920, CV_8UC1)};
};

TEST_F(Inputs, WithoutHeightLengthsAreInInitialHeights) {
  const FlightInputs inputs = read();
  EXPECT_EQ(inputs.initial.scale, ScaleSource::none);
  EXPECT_EQ(inputs.initial.world_from_body.translation, Eigen::Vector3d(0, 0, 1));
  EXPECT_TRUE(inputs.truth.empty());
}

TEST_F(Inputs, MountPitchesOpticalAxisBelowTheHorizon) {
  struct Case {
    double down_deg;
    Eigen::Vector3d axis;  // optical, in the body
  };
  const double r = std::sqrt(0.5);
  for (const Case& c : {Case{0, {1, 0, 0}}, Case{90, {0, 0, -1}}, Case{45, {r, 0, -r}}}) {
    config.mount.down_deg = c.down_deg;
    const Eigen::Quaterniond q = read().body_from_camera.rotation;
    EXPECT_LT((q * Eigen::Vector3d::UnitZ() - c.axis).norm(), 1e-12) << c.down_deg;
    EXPECT_LT((q * Eigen::Vector3d::UnitX() - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
  }
  // looking down, image up is body forward
  config.mount.down_deg.reset();
  const Eigen::Quaterniond q = read().body_from_camera.rotation;
  EXPECT_LT((q * Eigen::Vector3d(0, -1, 0) - Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

TEST_F(Inputs, InitialPoseIsTheTruthAtTheFirstFrame) {
  config.truth.path = folder.file("t.tum", "1 0 0 10 0 0 0 1\n2 2 4 20 0 0 0 1\n");
  config.initial.from_truth = true;
  const FlightInputs inputs = read();
  EXPECT_EQ(inputs.initial.scale, ScaleSource::initial_height);
  EXPECT_LT((inputs.initial.world_from_body.translation - Eigen::Vector3d(1, 2, 15)).norm(), 1e-12);
  EXPECT_EQ(inputs.truth.poses.size(), 2u);

  config.truth.ground_z_m = 2.5;
  EXPECT_EQ(read().initial.world_from_body.translation.z(), 12.5);
  EXPECT_EQ(read().truth.poses[1].world_from_body.translation.z(), 17.5);

  first.stamp = from_seconds(0.5);
  EXPECT_EQ(error(),
            "initial.from_truth: the truth covers 1 s to 2 s, the first frame is at 0.5 s; "
            "choose source.start_s within the truth, or set truth.time_offset_s");
  config.truth.path.reset();
  EXPECT_NE(error().find("no truth; set truth.path"), std::string::npos);
}

TEST_F(Inputs, TruthFolderWithoutDataMeansNoTruth) {
  folder.write("truth/sensor.yaml", "x: 1\n");
  config.truth.path = folder.path() / "truth";
  EXPECT_TRUE(read().truth.empty());
}

TEST_F(Inputs, TruthOfPositionsLeavesTheInitialAttitude) {
  config.truth.positions = folder.file("p.csv", "#t [s],x,y,z\n1,0,0,10\n2,2,4,20\n");
  config.initial.from_truth = true;
  config.initial.yaw_deg = 90;
  const FlightInputs inputs = read();
  EXPECT_FALSE(inputs.truth.has_attitude);
  EXPECT_LT((inputs.initial.world_from_body.translation - Eigen::Vector3d(1, 2, 15)).norm(), 1e-12);
  EXPECT_NEAR(so3_log(inputs.initial.world_from_body.rotation).z(), 90 * kDegree, 1e-12);
  config.truth.path = config.truth.positions;
  EXPECT_EQ(error(), "truth.path and truth.positions are both set; keep one");
}

TEST_F(Inputs, TruthOfVelocitiesIsInTheWorldOrInTheCamera) {
  config.truth.velocity = folder.file("w.csv", "#t [s],vx,vy,vz\n1,1,2,3\n");
  config.truth.time_offset_s = -0.25;
  const GroundTruth in_world = read().truth;
  ASSERT_EQ(in_world.velocities.size(), 1u);
  EXPECT_EQ(in_world.velocities[0].stamp.ns, 750000000);
  EXPECT_TRUE(in_world.twists_in_camera.empty());
  config.truth.velocity = folder.file("c.csv", "#t [s],vx,vy,vz,wx,wy,wz\n1,1,2,3,4,5,6\n");
  EXPECT_EQ(read().truth.twists_in_camera.at(0).twist.angular_rate_rad_s.z(), 6);
  EXPECT_TRUE(read().truth.velocities.empty());
  config.truth.velocity = folder.file("f.csv", "#t [s],vx,vy,vz,speed\n1,1,2,3,4\n");
  EXPECT_NE(error().find("5 columns; expected 4"), std::string::npos);
}

TEST_F(Inputs, RangeFinderGivesInitialHeight) {
  config.height = {.source = HeightSource::range,
                   .path = folder.file("h.csv", "t [s],h\n1.4,8\n1.6,10\n")};
  const FlightInputs inputs = read();
  EXPECT_EQ(inputs.initial.scale, ScaleSource::range);
  EXPECT_NEAR(inputs.initial.world_from_body.translation.z(), 9, 1e-9);
}

TEST_F(Inputs, RejectsMillimetresOfRangeAndTruth) {
  config.height = {.source = HeightSource::range,
                   .path = folder.file("h.csv", "t [s],h\n1.4,8000\n1.6,8100\n")};
  EXPECT_EQ(error(),
            "height.path: the median distance is 8100 m, expected below 3000 m; give it in metres, "
            "or set initial.height_m");
  config.height = {};
  config.truth.positions =
      folder.file("p.csv", "t [s],x,y,z\n0,0,0,8000\n1,2000,0,8000\n2,4000,0,8000\n");
  EXPECT_EQ(error(),
            "truth.positions: the truth moves at 2000 m/s (median), expected below 340; give its "
            "positions in metres");
}

TEST_F(Inputs, RejectsRangeInconsistentWithInitialHeight) {
  config.height = {.source = HeightSource::range,
                   .path = folder.file("h.csv", "t [s],h\n1.4,8000\n1.6,8100\n")};
  config.initial.height_m = 8;
  EXPECT_NE(error().find("disagrees with the initial height"), std::string::npos);
  config.initial.height_m = 8100;
  EXPECT_EQ(error(), "accepted");
}

TEST_F(Inputs, RejectsTwoInitialStates) {
  config.truth.path = folder.file("t.tum", "1 0 0 10 0 0 0 1\n2 2 4 20 0 0 0 1\n");
  config.initial.from_truth = true;
  config.initial.height_m = 20;
  EXPECT_NE(error().find("are both set; keep one"), std::string::npos);
}

TEST_F(Inputs, RejectsCoefficientCountOfAnotherDistortionModel) {
  CameraConfig& camera = *config.calibration.camera;
  camera.coefficients = {-0.3, 0.1, 0, 0};
  EXPECT_EQ(
      error(),
      "calibration.camera.coefficients: 4 coefficients without a distortion model; set distortion");
  camera.distortion = DistortionModel::radial_tangential;
  EXPECT_EQ(error(), "accepted");
  camera.coefficients = {-0.3, 0.1, 0};
  EXPECT_NE(error().find("3 coefficients, expected 4, 5 or 8"), std::string::npos);
  camera.coefficients = {-0.3, 0.1, 0, 0, 0};
  camera.distortion = DistortionModel::equidistant;
  EXPECT_NE(error().find("5 coefficients, expected 4"), std::string::npos);
}

// The z axis of the camera is the body's.
constexpr const char* kSensorLookingUp = R"(sensor_type: camera
camera_model: pinhole
resolution: [1920, 1080]
intrinsics: [1152, 1152, 959.5, 539.5]
distortion_model: none
T_BS: {rows: 4, cols: 4, data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}
)";

// The position would be ignored otherwise.
TEST_F(Inputs, RejectsMountPositionWithCalibrationExtrinsics) {
  config.calibration = {.path = folder.file("sensor.yaml", kSensorLookingUp), .camera = {}};
  EXPECT_EQ(error(), "accepted");
  config.mount.position_m = {0.1, 0, 0};
  EXPECT_NE(error().find("mount.position_m: the calibration has extrinsics"), std::string::npos);
  config.mount.down_deg = 30;
  EXPECT_EQ(error(), "accepted");
}

TEST_F(Inputs, ReportsAMountThatContradictsTheCalibration) {
  config.calibration = {.path = folder.file("sensor.yaml", kSensorLookingUp), .camera = {}};
  EXPECT_FALSE(read().mount_note);
  config.mount.rotation_wxyz = {std::cos(0.02), std::sin(0.02), 0, 0};  // 2.3 deg
  EXPECT_FALSE(read().mount_note);
  config.mount.rotation_wxyz = {std::cos(0.05), std::sin(0.05), 0, 0};  // 5.7 deg
  EXPECT_NE(read().mount_note.value_or("").find("mount.rotation_wxyz replaces the calibration's "
                                                "mount, which differs by 6 deg (its optical axis "
                                                "is -90 deg below"),
            std::string::npos);
  config.mount.rotation_wxyz.reset();
  config.mount.down_deg = 90;
  EXPECT_NE(read().mount_note.value_or("").find("which differs by 180 deg"), std::string::npos);
}

// A triangle wave of 1 rad/s at 10 readings per second: second differences of 4 rad/s.
TEST_F(Inputs, ALowRateRaisesTheNoiseOfTheImu) {
  const auto density = [&](double interval_s) {
    std::string rows = "t [s],wx,wy,wz,ax,ay,az\n";
    for (int i = 0; i < 40; ++i) {
      const int w = i % 2 == 0 ? 1 : -1;
      rows += std::to_string(interval_s * i) + "," + std::to_string(w) + ",0,0,0,0,9.8\n";
    }
    config.imu.path = folder.file("imu.csv", rows);
    return read().sensors.imu_noise.gyro_density;
  };
  const double own = FusionConfig{}.gyro_density;
  const double step_variance = 16.0 / 3 / 2 - 3 * own * own / 0.1;
  EXPECT_NEAR(density(0.1).value_or(0), std::hypot(own, std::sqrt(step_variance * 0.1 / 12)), 1e-6);
  EXPECT_FALSE(density(0.01));
}

TEST_F(Inputs, AlignsBarometerToInitialHeight) {
  config.height = {.source = HeightSource::barometer,
                   .path = folder.file("h.csv", "t [s],h\n1.4,308\n1.6,310\n")};
  EXPECT_NE(error().find("a barometer measures relative height"), std::string::npos);
  config.initial.height_m = 20;
  EXPECT_NEAR(read().sensors.height_m.values[1], 21, 1e-9);
}

// Kalibr: t_imu = t_cam + timeshift. A reading stamped 2.06 by an IMU that is 0.06 s ahead was
// taken at 2.0 of the camera.
TEST_F(Inputs, SensorLogsAreOnTheClockOfTheImages) {
  config.calibration.camera.reset();
  config.imu.path = folder.file("imu.csv", "t [s],wx,wy,wz,ax,ay,az\n2.06,0,0,0,0,0,9.8\n");
  const auto first_stamp_s = [&](const std::string& timeshift) {
    config.calibration.path = folder.file("c.yaml", R"(cam0:
  camera_model: pinhole
  resolution: [1920, 1080]
  intrinsics: [1152, 1152, 959.5, 539.5]
  distortion_model: none
  timeshift_cam_imu: )" + timeshift);
    return to_seconds(read().sensors.imu.stamps[0]);
  };
  EXPECT_NEAR(first_stamp_s("0.06"), 2.0, 1e-9);
  EXPECT_NEAR(first_stamp_s("-0.06"), 2.12, 1e-9);
  config.imu.time_offset_s = 1;  // replaces the timeshift
  EXPECT_NEAR(first_stamp_s("0.06"), 3.06, 1e-9);
  EXPECT_NEAR(to_seconds(read().sensors.angular_rate_in_body_rad_s.stamps[0]), 3.06, 1e-9);

  config.imu = {};
  config.height = {.source = HeightSource::range,
                   .path = folder.file("h.csv", "t [s],h [m]\n2,10\n"),
                   .time_offset_s = -0.5};
  EXPECT_NEAR(to_seconds(read().sensors.height_m.stamps[0]), 1.5, 1e-9);
}

// Sensor axes: x down, y left, z forward.
TEST_F(Inputs, SensorLogsAreInTheAxesOfTheBody) {
  const double r = std::sqrt(0.5);
  const std::array<double, 4> rotation{r, 0, r, 0};  // 90 deg about y: x to -z, z to x
  config.imu.path = folder.file("imu0/data.csv", "1,0.1,0.2,0.3,-9.8,0.5,0.6\n");
  config.imu.rotation_wxyz = rotation;
  const Vector6d expected = (Vector6d() << 0.3, 0.2, -0.1, 0.6, 0.5, 9.8).finished();
  EXPECT_LT((read().sensors.imu.values[0] - expected).norm(), 1e-9);

  // the same by imu0/sensor.yaml
  config.imu.rotation_wxyz.reset();
  folder.write("imu0/sensor.yaml", R"(sensor_type: imu
T_BS: {rows: 4, cols: 4, data: [0, 0, 1, 0.1, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1]}
gyroscope_noise_density: 2e-3
accelerometer_noise_density: 1e-3
accelerometer_random_walk: 4e-3
)");
  const SensorLog by_file = read().sensors;
  EXPECT_LT((by_file.imu.values[0] - expected).norm(), 1e-9);
  EXPECT_DOUBLE_EQ(by_file.imu_lever_arm_m, 0.1);
  EXPECT_EQ(by_file.imu_noise.gyro_density, 2e-3);
  EXPECT_EQ(by_file.imu_noise.accel_bias_walk, 4e-3);
  EXPECT_EQ(by_file.imu_noise.accel_density, FusionConfig{}.accel_density) << "at rest";
  EXPECT_FALSE(by_file.imu_noise.gyro_bias_walk.has_value());
  config.imu.noise.gyro_density = 1e-3;
  EXPECT_EQ(read().sensors.imu_noise.gyro_density, 1e-3);
  folder.write("imu0/sensor.yaml", "sensor_type: imu\ntime_offset: 0.01\n");
  EXPECT_NE(error().find("time_offset: looks like a clock offset"), std::string::npos) << error();
  folder.write("imu0/sensor.yaml", "sensor_type: camera\nT_BS: 1\n");
  config.imu.rotation_wxyz = rotation;
  EXPECT_EQ(error(), "accepted");
  config.imu.rotation_wxyz = {2, 0, 0, 0};
  EXPECT_EQ(error(), "imu.rotation_wxyz: the norm is 2, must be 1");

  config.imu = {};
  config.gyro.path = folder.file("gyro.csv", "1,0.1,0.2,0.3\n");
  config.gyro.rotation_wxyz = rotation;
  EXPECT_LT((read().sensors.angular_rate_in_body_rad_s.values[0] - Eigen::Vector3d(0.3, 0.2, -0.1))
                .norm(),
            1e-9);
  // world_from_sensor of a level body is the sensor's rotation
  config.attitude.path = folder.file("a.csv", "1,0.7071067812,0,0.7071067812,0\n");
  config.attitude.rotation_wxyz = rotation;
  EXPECT_LT(angle_between_rad(read().sensors.attitude.values[0], Eigen::Quaterniond::Identity()),
            1e-9);
}

TEST_F(Inputs, MaskIsBlackWhereTheSceneIsHidden) {
  EXPECT_EQ(read().mask, nullptr);
  cv::Mat mask(1080, 1920, CV_8UC3, cv::Scalar::all(255));
  mask.rowRange(0, 270) = cv::Scalar::all(0);
  const std::filesystem::path file = folder.path() / "mask.png";
  config.calibration.mask_path = file;
  const auto error_with = [&](const cv::Mat& image) {
    cv::imwrite(file.string(), image);
    return error();
  };
  EXPECT_EQ(error_with(mask), "accepted");
  EXPECT_DOUBLE_EQ(read().mask->masked_ratio(), 0.25);
  EXPECT_EQ(read().mask->masked_ratio(960, 100, 10, 10), 1);
  EXPECT_NE(error_with(mask.rowRange(0, 1000)).find("is 1920x1000, but the images are 1920x1080"),
            std::string::npos);
  EXPECT_NE(error_with(0 * mask).find("is entirely black"), std::string::npos);
  std::filesystem::remove(file);
  EXPECT_NE(error().find("is missing or not an image"), std::string::npos);
}

TEST_F(Inputs, ErrorsNameKeyAndRemedy) {
  first.grey = cv::Mat(480, 640, CV_8UC1);
  config.source.path = "v.mp4";
  EXPECT_EQ(error(),
            "calibration.camera: calibration of 1920x1080 images, but v.mp4 has 640x480; give the "
            "calibration of this resolution");
  config.calibration.path = "c.yaml";
  EXPECT_EQ(error(), "calibration.path and calibration.camera are both set; keep one");
  config.calibration = {};
  EXPECT_EQ(error(), "v.mp4: no calibration found; set calibration.path or calibration.camera");
  config.calibration.camera =
      CameraConfig{.width_px = 640, .height_px = 480, .centre_x_px = 320, .centre_y_px = 240};
  config.gyro.path = config.imu.path = folder.file("imu.csv", "1,0,0,0,0,0,9.8\n");
  EXPECT_EQ(error(),
            "gyro.path and imu.path are both set; keep one (imu.path includes the angular rates)");
  config.gyro = config.imu = {};
  config.height.source = HeightSource::range;
  EXPECT_NE(error().find("height.source and height.path: set both or neither"), std::string::npos);
  config.height.path = folder.file("range.csv", "1000000000,0\n2000000000,-1\n");
  EXPECT_EQ(error(), "range.csv: no distance above 0");
  config.height = {};
  config.truth.path = folder.file("t.tum", "1 0 0 -3 0 0 0 1\n2 2 4 -3 0 0 0 1\n");
  config.initial.from_truth = true;
  EXPECT_NE(error().find("initial camera height -3.000 m"), std::string::npos);
}

TEST_F(Inputs, RemovesRangesWithoutEcho) {
  config.height.source = HeightSource::range;
  config.height.path =
      folder.file("range.csv", "1000000000,20\n1100000000,0\n1200000000,-1\n1300000000,20\n");
  EXPECT_EQ(read().sensors.height_m.values, (std::vector<double>{20, 20}));
}

}  // namespace
}  // namespace stillkite
