#include "recording_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/core.hpp>

#include "evaluation/association.hpp"

namespace stillkite::bench {
namespace {

constexpr double kRate_hz = 20;
constexpr double kImuRate_hz = 1000;
constexpr int kImages = 41;
const Eigen::Vector3d kGravity_m_s2(0, 0, -9.81);

RigidTransform true_pose(double t_s) {
  const Eigen::Vector3d w(0.3 * std::sin(1.1 * t_s), 0.2 * std::cos(0.7 * t_s), 0.5 * t_s);
  const Eigen::Vector3d p(std::sin(t_s), 0.4 * t_s * t_s, 5 + 0.3 * std::cos(2 * t_s));
  return {so3_exp(w), p};
}

Timestamp stamp(double t_s) {
  return from_seconds(100 + t_s);
}

// Angular rate and specific force by central differences of the trajectory over +-h.
Vector6d imu_reading(const std::function<RigidTransform(double)>& pose_at_s, double t_s) {
  constexpr double kStep_s = 1e-3;
  const RigidTransform before = pose_at_s(t_s - kStep_s);
  const RigidTransform now = pose_at_s(t_s);
  const RigidTransform after = pose_at_s(t_s + kStep_s);
  const Eigen::Vector3d acceleration =
      (after.translation - 2 * now.translation + before.translation) / (kStep_s * kStep_s);
  Vector6d reading;
  reading << so3_log(before.rotation.conjugate() * after.rotation) / (2 * kStep_s),
      now.rotation.conjugate() * (acceleration - kGravity_m_s2);
  return reading;
}

// True poses at the rate of the IMU.
Recording flight() {
  Recording recording{.camera = {.width_px = 64,
                                 .height_px = 48,
                                 .focal_x_px = 50,
                                 .focal_y_px = 52,
                                 .centre_x_px = 30,
                                 .centre_y_px = 26,
                                 .distortion = DistortionModel::radial_tangential,
                                 .coefficients = {-0.2, 0.05, 0.003, -0.004}},
                      .body_from_camera = {so3_exp({0.4, 2.5, 0.3}), {0.05, -0.02, 0.1}},
                      .images = {},
                      .poses = {},
                      .twists_in_camera = {},
                      .imu = {},
                      .imu_noise = {}};
  for (int i = 0; i < kImages; ++i) {
    recording.images.push_back({stamp(i / kRate_hz), cv::Mat(48, 64, CV_8UC1, cv::Scalar(i))});
    if (i == 0) continue;
    const RigidTransform before = true_pose((i - 1) / kRate_hz) * recording.body_from_camera;
    const RigidTransform now = true_pose(i / kRate_hz) * recording.body_from_camera;
    recording.twists_in_camera.push_back(
        {stamp(i / kRate_hz), mean_twist(before, now, 1 / kRate_hz)});
  }
  for (int i = 0; i <= (kImages - 1) * kImuRate_hz / kRate_hz; ++i) {
    const double t_s = i / kImuRate_hz;
    recording.poses.push_back({stamp(t_s), true_pose(t_s)});
    recording.imu.stamps.push_back(stamp(t_s));
    recording.imu.values.push_back(imu_reading(true_pose, t_s));
  }
  return recording;
}

RigidTransform camera_at(const Recording& recording, Timestamp at) {
  return pose_at(recording.poses, at, 1e-6).value() * recording.body_from_camera;
}

void expect_twists_of_poses(const Recording& recording, double tolerance) {
  ASSERT_EQ(recording.twists_in_camera.size(), recording.images.size() - 1);
  for (std::size_t i = 1; i < recording.images.size(); ++i) {
    const Timestamp before = recording.images[i - 1].stamp;
    const Timestamp now = recording.images[i].stamp;
    const Twist expected = mean_twist(camera_at(recording, before), camera_at(recording, now),
                                      seconds_between(before, now));
    const StampedTwist& row = recording.twists_in_camera[i - 1];
    EXPECT_EQ(row.stamp, now);
    EXPECT_LT((row.twist.vector() - expected.vector()).norm(), tolerance) << "image " << i;
  }
}

void expect_imu_of_poses(const Recording& recording) {
  const auto pose_at_s = [&](double t_s) {
    return pose_at(recording.poses, stamp(t_s), 1e-6).value();
  };
  ASSERT_EQ(recording.imu.stamps.size(), recording.poses.size());
  for (std::size_t i = 1; i + 1 < recording.imu.stamps.size(); i += 7) {
    const double t_s = seconds_between(stamp(0), recording.imu.stamps[i]);
    const Vector6d expected = imu_reading(pose_at_s, t_s);
    EXPECT_LT((recording.imu.values[i] - expected).norm(), 1e-6) << "reading " << i;
  }
}

// Pixel of a point of the world in image `i`.
Eigen::Vector2d pixel(const Recording& recording, std::size_t i, const Eigen::Vector3d& point) {
  const RigidTransform camera = camera_at(recording, recording.images[i].stamp);
  return project(recording.camera, camera.inverse() * point).value();
}

// Point of the world in view of image `i`, off the principal point.
Eigen::Vector3d point_in_view(const Recording& recording, std::size_t i) {
  return camera_at(recording, recording.images[i].stamp) * Eigen::Vector3d(0.4, -0.3, 2);
}

TEST(RecordingMotion, DifferencesOfTheRecordingsOwnPosesAreItsTwistsAndReadings) {
  expect_twists_of_poses(flight(), 1e-12);
  expect_imu_of_poses(flight());
}

TEST(RecordingMotion, BackwardsTwistsAreDifferencesOfItsPoses) {
  expect_twists_of_poses(backwards(flight()), 1e-12);
}

TEST(RecordingMotion, BackwardsImuIsTheDerivativeOfItsPoses) {
  expect_imu_of_poses(backwards(flight()));
}

TEST(RecordingMotion, BackwardsTwiceIsTheRecording) {
  const Recording once = flight();
  const Recording twice = backwards(backwards(once));
  EXPECT_EQ(twice.camera, once.camera);
  EXPECT_LT(angle_between_rad(twice.body_from_camera.rotation, once.body_from_camera.rotation),
            1e-12);
  EXPECT_EQ(twice.images.front().stamp, once.images.front().stamp);
  EXPECT_EQ(twice.images.front().grey.at<unsigned char>(0, 0), 0);
  EXPECT_EQ(twice.imu.values.front(), once.imu.values.front());
}

TEST(RecordingMotion, BackwardsCameraSeesPointsInTheImageRotatedByHalfATurn) {
  const Recording recording = flight();
  const Eigen::Vector3d point = point_in_view(recording, 10);
  const Eigen::Vector2d before = pixel(recording, 10, point);
  const Eigen::Vector2d after = pixel(backwards(recording), kImages - 1 - 10, point);
  EXPECT_NEAR(after.x(), recording.camera.width_px - 1 - before.x(), 1e-9);
  EXPECT_NEAR(after.y(), recording.camera.height_px - 1 - before.y(), 1e-9);
}

TEST(RecordingMotion, MirroredTwistsAreDifferencesOfItsPoses) {
  expect_twists_of_poses(mirrored(flight()), 1e-12);
}

TEST(RecordingMotion, MirroredImuIsTheDerivativeOfItsPoses) {
  expect_imu_of_poses(mirrored(flight()));
}

TEST(RecordingMotion, MirroredCameraSeesMirroredPointsInTheFlippedImage) {
  const Recording recording = flight();
  const Eigen::Vector3d point = point_in_view(recording, 10);
  const Eigen::Vector2d before = pixel(recording, 10, point);
  const Eigen::Vector2d after =
      pixel(mirrored(recording), 10, Eigen::Vector3d(point.x(), -point.y(), point.z()));
  EXPECT_NEAR(after.x(), recording.camera.width_px - 1 - before.x(), 1e-9);
  EXPECT_NEAR(after.y(), before.y(), 1e-9);
}

TEST(RecordingMotion, TwistsOfEveryThirdImageAreDifferencesOfItsPoses) {
  const Recording third = every_nth_image(flight(), 3);
  EXPECT_EQ(third.images.size(), 14U);
  // the chord over three intervals and the mean of three chords differ by the curvature
  expect_twists_of_poses(third, 2e-3);
}

TEST(RecordingMotion, OriginIsBelowTheFirstPoseAndHeightsAreKept) {
  const Recording moved = from_origin(flight());
  const Eigen::Vector3d first = moved.poses.front().world_from_body.translation;
  EXPECT_LT(first.head<2>().norm(), 1e-12);
  EXPECT_NEAR(first.z(), true_pose(0).translation.z(), 1e-12);
}

}  // namespace
}  // namespace stillkite::bench
