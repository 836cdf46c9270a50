#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "estimation/twist.hpp"
#include "geometry/camera.hpp"
#include "geometry/plane.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {

/// One exact motion over a textured plane: roll 4 deg, pitch 6 deg, 1920x1080, no distortion.
struct BenchMotion {
  double height_m;
  double forward_m_s;  ///< along the world's x
  double frames_per_s;
  double focal_px;
  Eigen::Vector3d angular_rate_in_camera_rad_s;
};

/// High and fast: the flow paper's camera.
inline const BenchMotion kBenchSceneA{400, 25, 25, 1152, {.02, -.03, .05}};
/// Low and turning.
inline const BenchMotion kBenchSceneB{10, 2, 30, 1800, {.1, -.15, .2}};

struct BenchScene {
  Camera camera;
  double interval_s = 0;
  RigidTransform world_from_previous;  ///< pose of the camera
  RigidTransform world_from_current;
  GroundPlane ground;     ///< as the previous camera sees it
  Twist twist_in_camera;  ///< constant in the camera frame from one to the other: a screw motion
  cv::Mat previous;       ///< noise-free, CV_32FC1, grey values
  cv::Mat current;
};

/// `texture`: CV_8UC1, e.g. a photograph; laid so that a pixel is 1.25 texels. Empty: a procedural
/// ground of that seed.
[[nodiscard]] BenchScene make_bench_scene(const BenchMotion& motion, const cv::Mat& texture,
                                          std::uint64_t seed, int supersampling = 2);

struct FramePair {
  cv::Mat previous;  ///< CV_8UC1
  cv::Mat current;
};

/// The pair as a camera delivers it, with fresh noise in both images for every seed.
[[nodiscard]] FramePair with_noise(const BenchScene& scene, double noise_grey, std::uint64_t seed);

}  // namespace stillkite
