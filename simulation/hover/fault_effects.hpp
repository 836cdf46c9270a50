#pragma once

#include <opencv2/core/mat.hpp>

#include "simulation/hover/fault.hpp"
#include "simulation/hover/hover_readings.hpp"
#include "simulation/scene/patch_scene.hpp"

namespace stillkite {

/// Adds the gyroscope bias and the heading error to the IMU readings. The tilt is unaffected: the
/// IMU's attitude filter takes it from the accelerometer.
[[nodiscard]] HoverReadings with_fault(HoverReadings readings, const FaultEffect& fault);

/// Occludes the upper part of an image (CV_32FC1) by a patterned sheet that oscillates
/// horizontally.
[[nodiscard]] cv::Mat occluded(const cv::Mat& irradiance, double ratio, double t_s);

/// Displaces the horizontal patches at z = 0; objects on the floor keep their positions.
[[nodiscard]] PatchScene displace_floor(PatchScene scene, const Eigen::Vector3d& by_m);

}  // namespace stillkite
