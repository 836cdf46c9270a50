#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "simulation/flight/simulate.hpp"
#include "simulation/flight/vehicle_path.hpp"

namespace stillkite {
namespace {

SimulationConfig small_flight() {
  SimulationConfig config;
  config.camera.width_px = 160;
  config.camera.height_px = 120;
  config.camera.focal_x_px = config.camera.focal_y_px = 120;
  config.camera.centre_x_px = 79.5;
  config.camera.centre_y_px = 59.5;
  config.flight.duration_s = 0.4;
  config.flight.height_m = 50;
  config.flight.forward_m = 4;
  config.flight.left_m = config.flight.climb_m = 0;
  config.ground.side_texels = 512;
  return config;
}

std::vector<cv::Mat> render_frames(const SimulationConfig& config) {
  std::vector<cv::Mat> frames;
  render_flight(config, {}, [&](const Frame& frame) {
    EXPECT_EQ(frame.index, static_cast<std::int64_t>(frames.size()));
    frames.push_back(frame.grey);
  });
  return frames;
}

TEST(RenderFlight, IsDeterministicInSeed) {
  const SimulationConfig config = small_flight();
  const std::vector<cv::Mat> once = render_frames(config);
  const std::vector<cv::Mat> twice = render_frames(config);
  ASSERT_EQ(once.size(), 11u);
  ASSERT_EQ(twice.size(), 11u);
  for (std::size_t k = 0; k < once.size(); ++k) {
    EXPECT_EQ(cv::norm(once[k], twice[k], cv::NORM_INF), 0) << k;
  }
  SimulationConfig other = config;
  other.seed = 2;
  EXPECT_GT(cv::norm(once[0], render_frames(other)[0], cv::NORM_INF), 20);
}

TEST(RenderFlight, RendersFramePerGroundTruthStamp) {
  SimulationConfig config = small_flight();
  config.camera.frames_per_s = 30;
  const FlightRecord record = record_flight(config);
  ASSERT_EQ(record.truth.size(), 13u);
  std::vector<Timestamp> stamps;
  render_flight(config, {}, [&](const Frame& frame) { stamps.push_back(frame.stamp); });
  ASSERT_EQ(stamps.size(), record.truth.size());
  for (std::size_t k = 0; k < stamps.size(); ++k) EXPECT_EQ(stamps[k], record.truth[k].stamp);
  EXPECT_EQ(record.truth[1].stamp.ns, 33333333);
  EXPECT_EQ(record.imu.size(), 81u);
}

TEST(RenderFlight, AppliesGainRamp) {
  SimulationConfig config = small_flight();
  config.camera.noise_grey = 0;
  const std::vector<cv::Mat> even = render_frames(config);
  config.camera.gain_ramp_ratio = 0.3;
  const std::vector<cv::Mat> ramp = render_frames(config);
  for (std::size_t k = 0; k < even.size(); ++k) {
    const double gain = 1 + 0.03 * static_cast<double>(k);
    cv::Mat expected;
    even[k].convertTo(expected, CV_8UC1, gain);
    // rounding of both images
    EXPECT_LE(cv::norm(expected, ramp[k], cv::NORM_INF), 1) << k;
  }
}

TEST(RenderFlight, BlursMovingImagesOnly) {
  SimulationConfig config = small_flight();
  config.camera.noise_grey = 0;
  const auto sharpness = [](const cv::Mat& frame) {
    cv::Mat laplacian;
    cv::Laplacian(frame, laplacian, CV_32F);
    return cv::norm(laplacian, cv::NORM_L1);
  };
  const double sharp = sharpness(render_frames(config)[5]);
  config.camera.shutter_s = 0.3;  // over 7 pixels
  config.camera.shutter_samples = 16;
  EXPECT_LT(sharpness(render_frames(config)[5]), 0.7 * sharp);
  config.flight.forward_m = config.flight.sway_m = 0;
  config.flight.tilt_sway_deg = config.flight.yaw_sway_deg = 0;
  const cv::Mat hovering = render_frames(config)[5];
  config.camera.shutter_s = 0;
  EXPECT_LE(cv::norm(hovering, render_frames(config)[5], cv::NORM_INF), 1);
}

// Row of a rolling shutter = row of an instantaneous image at its time; mean differences of grey
// values. The middle row has the stamp of the image.
void expect_rows_at_their_times(SimulationConfig config, double max_same, double min_other) {
  config.camera.frames_per_s = 50;
  const std::vector<cv::Mat> at_once = render_frames(config);
  config.camera.frames_per_s = 25;
  config.camera.readout_s = 0.04;
  const cv::Mat rolled = render_frames(config)[5];
  const auto difference = [&](int row, int frame) {
    return cv::norm(rolled.row(row), at_once[static_cast<std::size_t>(frame)].row(row),
                    cv::NORM_L1) /
           rolled.cols;
  };
  EXPECT_LT(difference(0, 9), max_same);
  EXPECT_LT(difference(60, 10), max_same);
  EXPECT_LT(difference(119, 11), max_same);
  EXPECT_GT(difference(0, 10), min_other);
  EXPECT_GT(difference(119, 10), min_other);
}

TEST(RenderFlight, SimulatesRollingShutter) {
  SimulationConfig config = small_flight();
  config.camera.noise_grey = 0;
  config.flight.forward_m = 20;  // 5 pixels a frame
  expect_rows_at_their_times(config, 1, 5);
}

TEST(Vehicle, CoversConfiguredImageFractionAtHalfTime) {
  SimulationConfig config = small_flight();
  config.camera.noise_grey = 0;
  config.flight.tilt_sway_deg = 0;
  config.camera.frames_per_s = 5;
  const std::vector<cv::Mat> without = render_frames(config);
  config.vehicle = VehicleConfig{.image_share = 0.04, .crossing_s = 0.4};
  const std::vector<cv::Mat> with = render_frames(config);
  const cv::Mat changed = with[1] != without[1];
  EXPECT_NEAR(cv::countNonZero(changed) / double(changed.total()), 0.04, 0.003);
}

TEST(CameraMount, TiltsOpticalAxisTowardsNose) {
  SimulationConfig config = small_flight();
  EXPECT_LT((record_flight(config).body_from_camera.rotation * Eigen::Vector3d::UnitZ() -
             Eigen::Vector3d(0, 0, -1))
                .norm(),
            1e-12);
  config.camera.forward_tilt_deg = 30;
  const Eigen::Quaterniond tilted = record_flight(config).body_from_camera.rotation;
  EXPECT_LT(
      (tilted * Eigen::Vector3d::UnitZ() - Eigen::Vector3d(0.5, 0, -0.5 * std::sqrt(3.0))).norm(),
      1e-12);
  // image right stays -y of the body
  EXPECT_LT((tilted * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

// Reference: finite differences of the camera's position, body + R l.
TEST(CameraMount, LeverArmMovesCameraInBody) {
  SimulationConfig config = small_flight();
  config.flight.yaw_sway_deg = 40;
  config.flight.tilt_sway_deg = 10;
  config.camera.frames_per_s = 100;
  config.camera.forward_tilt_deg = 30;
  config.camera.lever_arm_m = {0.3, -0.1, 0.05};
  const FlightRecord record = record_flight(config);
  const Eigen::Vector3d arm(0.3, -0.1, 0.05);
  EXPECT_EQ(record.body_from_camera.translation, arm);
  for (std::size_t k = 1; k < record.truth.size(); ++k) {
    const RigidTransform& before = record.truth[k - 1].state.world_from_body;
    const RigidTransform& after = record.truth[k].state.world_from_body;
    const Eigen::Vector3d moved =
        (after.translation + after.rotation * arm) - (before.translation + before.rotation * arm);
    const Eigen::Quaterniond half_way =
        before.rotation.slerp(0.5, after.rotation) * record.body_from_camera.rotation;
    const Twist& twist = record.twists_in_camera[k - 1].twist;
    EXPECT_LT((half_way * twist.velocity_m_s - moved / 0.01).norm(), 1e-4);
  }
}

// Level aircraft: a lever arm l ahead gives the image of an aircraft that is l further ahead.
TEST(CameraMount, LeverArmShiftsImage) {
  SimulationConfig config = small_flight();
  config.camera.noise_grey = 0;
  config.flight.sway_m = config.flight.tilt_sway_deg = config.flight.yaw_sway_deg = 0;
  const cv::Mat later = render_frames(config)[5];  // 2 m ahead
  config.camera.lever_arm_m = {2, 0, 0};
  const cv::Mat ahead = render_frames(config)[0];
  EXPECT_LE(cv::norm(later, ahead, cv::NORM_INF), 1);
}

TEST(RenderFlight, RecordsArrivalStamps) {
  SimulationConfig config = small_flight();
  config.clock = {.image_delay_s = 0.03, .imu_offset_s = 0.1};
  std::vector<Timestamp> stamps;
  render_flight(config, {}, [&](const Frame& frame) { stamps.push_back(frame.stamp); });
  const FlightRecord record = record_flight(config);
  ASSERT_EQ(stamps.size(), record.truth.size());
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    EXPECT_EQ(stamps[k].ns, record.truth[k].stamp.ns + 30'000'000);
  }
  EXPECT_EQ(record.imu.front().stamp.ns, 100'000'000);
}

TEST(RecordFlight, GapsRemoveImuReadingsOnly) {
  SimulationConfig config = small_flight();
  const std::vector<ImuReading> all = record_flight(config).imu;
  config.imu.gap_s = 0.1;
  config.imu.gap_every_s = 0.2;
  const std::vector<ImuReading> kept = record_flight(config).imu;
  std::size_t next = 0;
  for (const ImuReading& reading : all) {
    const bool is_lost = (reading.stamp.ns >= 200'000'000 && reading.stamp.ns < 300'000'000) ||
                         reading.stamp.ns >= 400'000'000;
    if (is_lost) continue;
    ASSERT_LT(next, kept.size());
    EXPECT_EQ(kept[next].stamp, reading.stamp);
    EXPECT_EQ(kept[next].angular_rate_in_body_rad_s, reading.angular_rate_in_body_rad_s);
    ++next;
  }
  EXPECT_EQ(next, kept.size());
  EXPECT_EQ(all.size() - kept.size(), 21u);
}

// The same errors; specific force = acceleration - gravity in the body's axes.
TEST(RecordFlight, RemovesGravityFromSpecificForce) {
  SimulationConfig config = small_flight();
  config.flight.tilt_sway_deg = 10;
  const FlightRecord measured = record_flight(config);
  config.imu.removes_gravity = true;
  const std::vector<ImuReading> removed = record_flight(config).imu;
  ASSERT_EQ(removed.size(), measured.imu.size());
  for (const StampedState& truth : measured.truth) {
    const std::size_t k = static_cast<std::size_t>(std::lround(200 * to_seconds(truth.stamp)));
    ASSERT_EQ(removed[k].stamp, truth.stamp);
    const Eigen::Vector3d difference =
        measured.imu[k].specific_force_in_body_m_s2 - removed[k].specific_force_in_body_m_s2;
    EXPECT_LT((truth.state.world_from_body.rotation * difference + gravity_in_world_m_s2()).norm(),
              1e-9);
    EXPECT_EQ(removed[k].angular_rate_in_body_rad_s, measured.imu[k].angular_rate_in_body_rad_s);
  }
}

// Full well 10000 electrons, 2 % light, amplifier 8: grey 120 gives 94.1 electrons of 0.204 grey.
TEST(FlightCamera, NightHasPhotonNoise) {
  FlightCameraConfig camera;
  camera.noise_grey = 0.3;
  camera.light_ratio = 0.02;
  camera.amplifier_gain = 8;
  camera.full_well_electrons = 10000;
  const Exposure exposure = camera.exposure(1);
  const double signal_grey = exposure.gain * 120;
  EXPECT_NEAR(signal_grey, 94.1176 * 0.204, 1e-4);
  EXPECT_NEAR(exposure.photon_variance_per_grey * signal_grey, 94.1176 * 0.204 * 0.204, 1e-4);
  EXPECT_NEAR(exposure.noise_grey, 2.4, 1e-12);
}

SimulationConfig small_room_flight() {
  SimulationConfig config = small_flight();
  config.scene = FlightScene::room;
  config.camera.noise_grey = 0;
  config.camera.forward_tilt_deg = 80;
  config.flight = {.shape = FlightShape::hand, .duration_s = 0.4, .height_m = 1.5, .sway_m = 0.2};
  return config;
}

TEST(RenderFlight, RollsShutterInRoom) {
  SimulationConfig config = small_room_flight();
  config.flight.yaw_sway_deg = 80;
  expect_rows_at_their_times(config, 0.5, 1.5);
}

TEST(RenderFlight, ScenesDiffer) {
  SimulationConfig config = small_room_flight();
  const cv::Mat room = render_frames(config)[0];
  config.scene = FlightScene::coast;
  const cv::Mat coast = render_frames(config)[0];
  EXPECT_GT(cv::norm(room, coast, cv::NORM_L1) / static_cast<double>(room.total()), 10);
  // sky above, water below the horizon
  EXPECT_GT(cv::mean(coast.row(0))[0], cv::mean(coast.row(119))[0] + 50);
}

}  // namespace
}  // namespace stillkite
