#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>

#include "estimation/plane/keyframe_pose.hpp"
#include "estimation/plane/plane_alignment.hpp"
#include "geometry/euler.hpp"

// Two rendered views of textured ground, and their alignment.

namespace stillkite::test {

inline constexpr int kLevels = 3;

inline Camera lens(DistortionModel model) {
  Camera camera{.width_px = 320,
                .height_px = 240,
                .focal_x_px = 300,
                .focal_y_px = 305,
                .centre_x_px = 161,
                .centre_y_px = 118,
                .distortion = model};
  if (model != DistortionModel::none) camera.coefficients = {-0.2, 0.05};
  return camera;
}

inline RigidTransform pose(double x, double y, double z, double roll, double pitch, double yaw) {
  const Eigen::Quaterniond down(0, 1, 0, 0);  // camera x along body x, z down
  return {to_quaternion({.yaw_rad = yaw, .pitch_rad = pitch, .roll_rad = roll}) * down, {x, y, z}};
}

// Analytic grey value of the ground.
inline double ground(double x, double y) {
  return 128 + 30 * std::sin(23 * x + 5 * y) + 25 * std::sin(31 * y - 11 * x) +
         20 * std::sin(44 * x + 37 * y) + 15 * std::sin(61 * x - 47 * y);
}

// Rendered ground with one camera pose per row (rolling shutter).
inline cv::Mat render(const Camera& camera, const std::function<RigidTransform(int)>& pose_of_row,
                      double gain = 1, double offset = 0) {
  cv::Mat image(camera.height_px, camera.width_px, CV_8U);
  for (int row = 0; row < image.rows; ++row) {
    const RigidTransform world_from_camera = pose_of_row(row);
    for (int column = 0; column < image.cols; ++column) {
      const auto bearing = undistort(camera, {column, row});
      const Eigen::Vector3d ray = world_from_camera.rotation * bearing.value().homogeneous();
      const Eigen::Vector3d hit =
          world_from_camera.translation - ray * (world_from_camera.translation.z() / ray.z());
      image.at<std::uint8_t>(row, column) =
          cv::saturate_cast<std::uint8_t>(gain * ground(hit.x(), hit.y()) + offset);
    }
  }
  return image;
}
inline cv::Mat render(const Camera& camera, const RigidTransform& at, double gain = 1,
                      double offset = 0) {
  return render(
      camera, [&](int) { return at; }, gain, offset);
}

inline PlaneAlignment align(const Camera& camera, const cv::Mat& reference, const cv::Mat& current,
                            const PlaneMotion& initial, const TiltPrior& tilt = {},
                            const RollingShutter& shutter = {}, const SmoothErrors& smooth = {}) {
  Pyramid a, b;
  a.build(reference, kLevels);
  b.build(current, kLevels);
  PlaneAligner aligner(camera, {.levels = kLevels});
  aligner.set_reference(a);
  return aligner.align(b, initial, tilt, shutter, smooth);
}

inline double rotation_error_rad(const PlaneMotion& a, const PlaneMotion& b) {
  return angle_between_rad(a.rotation, b.rotation);
}
inline double translation_error(const PlaneMotion& a, const PlaneMotion& b) {
  return (a.translation - b.translation).norm();
}

inline const RigidTransform kFirst = pose(0, 0, 1.0, 0.1, -0.15, 0.2);
inline const RigidTransform kSecond = pose(0.03, -0.02, 1.02, 0.11, -0.14, 0.22);

}  // namespace stillkite::test
