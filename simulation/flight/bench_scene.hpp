#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "estimation/twist.hpp"
#include "geometry/camera.hpp"
#include "geometry/plane.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// Known motion over a textured plane: roll 4 deg, pitch 6 deg, 1920x1080, no distortion.
struct BenchMotion {
  double height_m;
  double forward_m_s;  ///< along the world x axis
  double frames_per_s;
  double focal_px;
  Eigen::Vector3d angular_rate_in_camera_rad_s;
};

/// High altitude, high speed; camera of the flow paper.
inline const BenchMotion kBenchSceneA{400, 25, 25, 1152, {.02, -.03, .05}};
/// Low altitude, high angular rate.
inline const BenchMotion kBenchSceneB{10, 2, 30, 1800, {.1, -.15, .2}};

struct BenchScene {
  Camera camera;
  double interval_s = 0;
  RigidTransform world_from_previous;  ///< camera pose
  RigidTransform world_from_current;
  GroundPlane ground;     ///< in the previous camera frame
  Twist twist_in_camera;  ///< constant in the camera frame: a screw motion
  cv::Mat previous;       ///< noise-free, CV_32FC1, grey values
  cv::Mat current;
};

/// `texture`: CV_8UC1, e.g. a photograph, scaled to 1.25 texels per pixel. Empty: a procedural
/// ground from `seed`.
[[nodiscard]] BenchScene make_bench_scene(const BenchMotion& motion, const cv::Mat& texture,
                                          std::uint64_t seed, int supersampling = 2);

struct FramePair {
  cv::Mat previous;  ///< CV_8UC1
  cv::Mat current;
};

/// Image pair with pixel noise and quantisation; seeds are independent, and so are the two images.
[[nodiscard]] FramePair with_noise(const BenchScene& scene, double noise_grey, std::uint64_t seed);

}  // namespace stillkite
